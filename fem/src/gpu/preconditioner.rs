//! P^-1 r on the device.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;
use crate::gpu::elimination::passes;
use crate::gpu::product::{self, Matrices, product};
use crate::gpu::units::Units;
use crate::precondition::planewise_diagonal::Component;
use crate::precondition::planewise_diagonal::PlanewiseDiagonal;

/// P^-1 times modulus and length, in two halves: a constraint on the end plane acts between them.
pub(super) struct Preconditioner {
    /// r to modal values, eliminated up to the end plane.
    pub gather: Vec<Work>,
    /// From there to z; uses the modal values up.
    pub spread: Vec<Work>,
    /// Modal values, component after component.
    pub modal: wgpu::Buffer,
}

impl Preconditioner {
    /// From the buffer `r` to the buffer `z`, which must be 0 on held planes.
    pub fn new(
        device: &Device,
        planewise: &PlanewiseDiagonal,
        units: &Units,
        [r, z]: [&wgpu::Buffer; 2],
    ) -> Result<Self, Error> {
        let [nx, ny, nz] = planewise.shape;
        let components = planewise.components.each_ref();
        let modal = device.room("modal values", planewise.mode_count())?;
        let passes = passes(device, components.map(|c| &c.z), units, &modal)?;
        let halves = components.map(|c| {
            let [mx, my] = c.pairs();
            c.z.planes.len() * (mx * ny).max(nx * my)
        });
        let half = device.room("halves of products", halves.into_iter().fold(0, usize::max))?;
        let kernel = product::kernel(device);
        let (mut gather, mut spread) = (Vec::new(), Vec::new());
        let passes = passes.gather.into_iter().zip(passes.spread);
        for ((c, component), (forward, backward)) in components.iter().enumerate().zip(passes) {
            let planes = Planes {
                device,
                kernel: &kernel,
                component,
                shape: planewise.shape,
                nodal_start: c * nx * ny * nz,
                vectors: vectors(device, component, units)?,
                half: &half,
                modal: &modal,
            };
            gather.extend(planes.to_modes(r)?);
            gather.push(forward);
            spread.push(backward);
            spread.extend(planes.leave_modes(z)?);
        }
        Ok(Preconditioner {
            gather,
            spread,
            modal,
        })
    }
}

/// Eigenvectors of x, then of y, column after column.
fn vectors(device: &Device, component: &Component, units: &Units) -> Result<wgpu::Buffer, Error> {
    let root = units.length.sqrt();
    let columns = [&component.x, &component.y].into_iter().flat_map(|modes| {
        let vectors = &modes.vectors;
        (0..vectors.ncols()).flat_map(move |m| vectors.col(m).iter())
    });
    let rounded: Vec<f32> = columns.map(|v| (v * root) as f32).collect();
    device.holding("eigenvectors", &rounded)
}

/// One component's planes: nodal in the order of z, modal in the order of elimination.
struct Planes<'a> {
    device: &'a Device,
    kernel: &'a wgpu::ComputePipeline,
    component: &'a Component,
    shape: [usize; 3],
    nodal_start: usize,
    vectors: wgpu::Buffer,
    half: &'a wgpu::Buffer,
    modal: &'a wgpu::Buffer,
}

impl Planes<'_> {
    /// H = Qx^T R for all planes at once, then H Qy plane by plane.
    fn to_modes(&self, nodal: &wgpu::Buffer) -> Result<[Work; 2], Error> {
        let [nx, ny, _] = self.shape;
        let [mx, my] = self.component.pairs();
        let count = self.component.z.planes.len();
        let lowest = self.lowest();
        let along_x = product(
            self.device,
            self.kernel,
            [mx, ny * count, nx, 1],
            matrices(&self.vectors, 0, [nx, 1], 0),
            matrices(nodal, self.nodal_start + lowest * nx * ny, [1, nx], 0),
            matrices(self.half, 0, [1, mx], 0),
        )?;
        let first = self.component.z.planes[0] - lowest;
        let along_y = product(
            self.device,
            self.kernel,
            [mx, my, ny, count],
            matrices(self.half, first * mx * ny, [1, mx], self.step(mx * ny)),
            matrices(&self.vectors, nx * mx, [1, ny], 0),
            matrices(
                self.modal,
                self.component.start,
                [1, mx],
                (mx * my) as isize,
            ),
        )?;
        Ok([along_x, along_y])
    }

    /// H = Qx M for all planes at once, then H Qy^T plane by plane.
    fn leave_modes(&self, nodal: &wgpu::Buffer) -> Result<[Work; 2], Error> {
        let [nx, ny, _] = self.shape;
        let [mx, my] = self.component.pairs();
        let count = self.component.z.planes.len();
        let along_x = product(
            self.device,
            self.kernel,
            [nx, my * count, mx, 1],
            matrices(&self.vectors, 0, [1, nx], 0),
            matrices(self.modal, self.component.start, [1, mx], 0),
            matrices(self.half, 0, [1, nx], 0),
        )?;
        let first = self.nodal_start + self.component.z.planes[0] * nx * ny;
        let along_y = product(
            self.device,
            self.kernel,
            [nx, ny, my, count],
            matrices(self.half, 0, [1, nx], (nx * my) as isize),
            matrices(&self.vectors, nx * mx, [ny, 1], 0),
            matrices(nodal, first, [1, nx], self.step(nx * ny)),
        )?;
        Ok([along_x, along_y])
    }

    /// The lowest plane that is not held.
    fn lowest(&self) -> usize {
        let planes = &self.component.z.planes;
        planes[0].min(planes[planes.len() - 1])
    }

    /// From plane to plane in the order of elimination, where planes of `size` lie in the order of z.
    fn step(&self, size: usize) -> isize {
        let planes = &self.component.z.planes;
        if planes[0] > self.lowest() {
            -(size as isize)
        } else {
            size as isize
        }
    }
}

fn matrices(
    buffer: &wgpu::Buffer,
    start: usize,
    [row, col]: [usize; 2],
    matrix: isize,
) -> Matrices<'_> {
    Matrices {
        buffer,
        start,
        row,
        col,
        matrix,
    }
}
