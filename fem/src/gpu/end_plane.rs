//! Conjugate gradients with a constraint on the plane that elimination ends on.
//!
//! An iteration is cut in two: [`DeviceCg::gather`] ends where the end plane has gathered all, the host decides on forces
//! there, and [`DeviceCg::spread`] goes on with them. Only that plane and some scalars go over.

use crate::error::Error;
use crate::gpu::cg::DeviceCg;
use crate::gpu::preconditioner::Preconditioner;
use crate::gpu::sums::{FACTORS, Progress};

/// The vertical component on the plane that elimination ends on.
#[derive(Clone, Debug)]
pub struct EndPlane {
    /// What it has gathered, modes of x fastest, as [`crate::PlanewiseDiagonal::gathered`].
    pub gathered: Vec<f64>,
    /// The residual on its nodes, x fastest.
    pub residual: Vec<f64>,
    /// The scalars so far.
    pub progress: Progress,
}

impl DeviceCg<'_> {
    /// Begins anew with the residual `r`, up to the end plane.
    pub fn gather_first(&mut self, r: &[f64]) {
        self.load(r, 0.0);
        self.device.start(self.preconditioner.gather.iter(), 1);
    }

    /// A step along the last direction, then on up to the end plane.
    pub fn gather(&mut self) {
        let works = [&self.operator].into_iter().chain(&self.advance);
        let works = works.chain(&self.preconditioner.gather);
        self.device.start(works, 1);
    }

    /// Waits for the end plane.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn end_plane(&self) -> Result<EndPlane, Error> {
        let mut factors = [0.0; FACTORS];
        let mut gathered = vec![0.0; self.end.modal[1]];
        let mut residual = vec![0.0; self.end.nodal[1]];
        self.device.read(&mut [
            (&self.sums.factors, 0, &mut factors),
            (&self.preconditioner.modal, self.end.modal[0], &mut gathered),
            (&self.residual, self.end.nodal[0], &mut residual),
        ])?;
        let back = self.scale.recip();
        let length = self.units.length;
        Ok(EndPlane {
            gathered: widened(&gathered, length.recip(), back),
            residual: widened(&residual, 1.0, back),
            progress: Progress::of(factors),
        })
    }

    /// From the end plane as it is to be now to the first or the next direction.
    pub fn spread(&mut self, plane: &EndPlane, first: bool) {
        assert_eq!(
            [plane.gathered.len(), plane.residual.len()],
            [self.end.modal[1], self.end.nodal[1]]
        );
        let gathered = rounded(&plane.gathered, self.units.length, self.scale);
        let residual = rounded(&plane.residual, 1.0, self.scale);
        let Preconditioner { spread, modal, .. } = &self.preconditioner;
        self.device.write(modal, self.end.modal[0], &gathered);
        self.device
            .write(&self.residual, self.end.nodal[0], &residual);
        let next = if first { &self.begin } else { &self.turn };
        self.device.start(spread.iter().chain(next), 1);
    }
}

/// The two factors come one after the other, as their product may be beyond the largest number.
fn widened(values: &[f32], factor: f64, back: f64) -> Vec<f64> {
    let wide = values.iter().map(|v| f64::from(*v) * factor * back);
    wide.collect()
}

fn rounded(values: &[f64], factor: f64, scale: f64) -> Vec<f32> {
    let scaled = values.iter().map(|v| v * scale * factor);
    scaled.map(|v| v as f32).collect()
}
