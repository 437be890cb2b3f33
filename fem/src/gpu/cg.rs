//! Conjugate gradients on the device, in single precision.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;
use crate::gpu::narrow::{add_widened, narrow};
use crate::gpu::operator::stiffness;
use crate::gpu::place::Place;
use crate::gpu::preconditioner::Preconditioner;
use crate::gpu::sums::{FACTORS, Progress, Sums};
use crate::gpu::units::Units;
use crate::precondition::planewise_diagonal::PlanewiseDiagonal;
use crate::tensor::operator::TensorOperator;

/// The kernels of one operator and its preconditioner, and conjugate gradients made of them.
///
/// Solves K d = r by the same recurrences as [`crate::cg::solve`], from d = 0. The factors alpha and beta stay on the device.
/// On one device the bits are the same from run to run: sums are taken in a fixed order.
pub struct DeviceCg<'a> {
    pub(super) device: &'a Device,
    pub(super) units: Units,
    nodes: usize,
    pub(super) residual: wgpu::Buffer,
    direction: wgpu::Buffer,
    image: wgpu::Buffer,
    preconditioned: wgpu::Buffer,
    correction: wgpu::Buffer,
    pub(super) sums: Sums,
    pub(super) operator: Work,
    pub(super) preconditioner: Preconditioner,
    pub(super) end: Place,
    /// From z = P^-1 r to the first direction.
    pub(super) begin: Vec<Work>,
    /// From K p to the new residual.
    pub(super) advance: Vec<Work>,
    /// From z = P^-1 r to the next direction.
    pub(super) turn: Vec<Work>,
    /// Numbers on their way.
    narrowed: Vec<f32>,
    /// What r was multiplied with.
    pub(super) scale: f64,
}

impl<'a> DeviceCg<'a> {
    /// The kernels on a device.
    ///
    /// # Errors
    /// [`Error::DeviceLimit`] where the grid is too large for the device, [`Error::Device`] where it fails.
    pub fn new(
        device: &'a Device,
        operator: &TensorOperator,
        planewise: &PlanewiseDiagonal,
    ) -> Result<Self, Error> {
        assert_eq!(operator.shape(), planewise.shape);
        let units = Units::of(operator);
        let numbers = 3 * operator.node_count();
        let vector = |what: &'static str| device.room(what, numbers);
        let residual = vector("residual")?;
        let direction = vector("direction")?;
        let image = vector("image")?;
        let preconditioned = vector("preconditioned residual")?;
        let correction = vector("correction")?;
        let sums = Sums::new(device)?;
        let preconditioner =
            Preconditioner::new(device, planewise, &units, [&residual, &preconditioned])?;
        let groups = [numbers.div_ceil(GROUP).min(MOST_GROUPS), 1, 1];
        let kernel = |entry: &'static str| device.kernel(include_str!("vectors.wgsl"), entry);
        let turn_works = || {
            let buffers = [(0, &sums.factors), (1, &preconditioned), (3, &direction)];
            device.work(&kernel("turn"), &buffers, groups)
        };
        let mut begin = Vec::from(sums.works(device, [&residual, &preconditioned], "begin")?);
        begin.push(turn_works()?);
        let mut turn = Vec::from(sums.works(device, [&residual, &preconditioned], "after")?);
        turn.push(turn_works()?);
        let mut advance = Vec::from(sums.works(device, [&direction, &image], "step")?);
        let buffers = [
            (0, &sums.factors),
            (1, &direction),
            (2, &image),
            (3, &correction),
            (4, &residual),
        ];
        advance.push(device.work(&kernel("advance"), &buffers, groups)?);
        let made = DeviceCg {
            operator: stiffness(device, operator, &units, [&direction, &image])?,
            end: Place::of(planewise),
            device,
            units,
            nodes: operator.node_count(),
            residual,
            direction,
            image,
            preconditioned,
            correction,
            sums,
            preconditioner,
            begin,
            advance,
            turn,
            narrowed: vec![0.0; numbers],
            scale: 1.0,
        };
        device.check()?;
        Ok(made)
    }

    /// `out` = K `u`, to single precision.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn apply(&mut self, u: &[f64], out: &mut [f64]) -> Result<(), Error> {
        let scale = narrow(u, &mut self.narrowed);
        self.device.write(&self.direction, 0, &self.narrowed);
        self.device.start([&self.operator].into_iter(), 1);
        self.device
            .read(&mut [(&self.image, 0, &mut self.narrowed)])?;
        out.fill(0.0);
        add_widened(out, self.units.stiffness(), &self.narrowed, scale);
        Ok(())
    }

    /// `z` = P^-1 `r`, to single precision.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn precondition(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), Error> {
        let scale = narrow(r, &mut self.narrowed);
        self.device.write(&self.residual, 0, &self.narrowed);
        let Preconditioner { gather, spread, .. } = &self.preconditioner;
        self.device.start(gather.iter().chain(spread), 1);
        self.device
            .read(&mut [(&self.preconditioned, 0, &mut self.narrowed)])?;
        z.fill(0.0);
        add_widened(z, self.units.stiffness().recip(), &self.narrowed, scale);
        Ok(())
    }

    /// Begins anew with the residual `r`, to go on until its norm has fallen by the factor `reduction`.
    pub fn start(&mut self, r: &[f64], reduction: f64) {
        self.load(r, reduction);
        let Preconditioner { gather, spread, .. } = &self.preconditioner;
        let works = gather.iter().chain(spread).chain(&self.begin);
        self.device.start(works, 1);
    }

    /// Hands so many iterations to the device; those after the target do nothing.
    pub fn iterate(&mut self, iterations: usize) {
        let Preconditioner { gather, spread, .. } = &self.preconditioner;
        let works = [&self.operator].into_iter().chain(&self.advance);
        let works = works.chain(gather).chain(spread).chain(&self.turn);
        self.device.start(works, iterations);
    }

    /// Waits for what was handed over.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn progress(&self) -> Result<Progress, Error> {
        let mut factors = [0.0; FACTORS];
        self.device
            .read(&mut [(&self.sums.factors, 0, &mut factors)])?;
        Ok(Progress::of(factors))
    }

    /// `x` += the correction d.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn add_correction(&mut self, x: &mut [f64]) -> Result<(), Error> {
        self.device
            .read(&mut [(&self.correction, 0, &mut self.narrowed)])?;
        let factor = self.units.stiffness().recip();
        add_widened(x, factor, &self.narrowed, self.scale);
        Ok(())
    }

    pub(super) fn load(&mut self, r: &[f64], reduction: f64) {
        assert_eq!(r.len(), 3 * self.nodes);
        self.scale = narrow(r, &mut self.narrowed);
        let squares = self.narrowed.iter().map(|v| f64::from(*v).powi(2));
        let target = reduction.powi(2) * squares.sum::<f64>();
        self.device.write(&self.residual, 0, &self.narrowed);
        self.device.clear([&self.direction, &self.correction]);
        self.sums.aim(self.device, target as f32);
    }
}

/// Threads of a group of the vector kernels, as the shader has them.
const GROUP: usize = 256;

/// Every device starts so many; threads take further numbers in turn.
const MOST_GROUPS: usize = 65535;
