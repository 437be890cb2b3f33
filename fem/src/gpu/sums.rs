//! Scalar products and the factors that follow from them, without leaving the device.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;

/// Groups that take the sums of a part each: as many as a group has threads, so that one group adds them up.
const GROUPS: usize = 256;

/// The scalars of conjugate gradients.
pub(super) struct Sums {
    parts: wgpu::Buffer,
    pub factors: wgpu::Buffer,
    products: wgpu::ComputePipeline,
}

/// What the device tells of its iterations.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// r . P^-1 r.
    pub rho: f32,
    /// Factor of the last step; 0 where there was none, as the target was reached or the energy not positive.
    pub alpha: f32,
    /// Factor of the last direction.
    pub beta: f32,
    /// r . r.
    pub residual: f32,
    /// Steps since the start.
    pub iterations: usize,
    /// p . K p of the last direction.
    pub energy: f32,
}

impl Sums {
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Sums {
            parts: device.room("sums", 2 * GROUPS)?,
            factors: device.room("factors", FACTORS)?,
            products: device.kernel(SOURCE, "products"),
        })
    }

    /// a . b and a . a, then what `entry` makes of them: `begin`, `step` or `after`.
    pub fn works(
        &self,
        device: &Device,
        [a, b]: [&wgpu::Buffer; 2],
        entry: &'static str,
    ) -> Result<[Work; 2], Error> {
        let kernel = device.kernel(SOURCE, entry);
        let products = [(0, a), (1, b), (2, &self.parts)];
        let finish = [(2, &self.parts), (3, &self.factors)];
        Ok([
            device.work(&self.products, &products, [GROUPS, 1, 1])?,
            device.work(&kernel, &finish, [1, 1, 1])?,
        ])
    }

    /// Sets r . r at which iterations end.
    pub fn aim(&self, device: &Device, target: f32) {
        device.write(&self.factors, 0, &[0.0, 0.0, 0.0, 0.0, target]);
    }
}

impl Progress {
    /// From what a device holds of [`Sums::factors`].
    pub(super) fn of(factors: [f32; FACTORS]) -> Self {
        let [rho, alpha, beta, residual, _, iterations, energy] = factors;
        Progress {
            rho,
            alpha,
            beta,
            residual,
            iterations: iterations as usize,
            energy,
        }
    }
}

/// Scalars that the shader keeps.
pub(super) const FACTORS: usize = 7;

const SOURCE: &str = include_str!("sums.wgsl");
