//! Problems that several contact tests share.

use std::sync::Arc;

use kufe_contact::{Ice, Load, Problem, Runner, Tilt};
use kufe_mesh::Underside;

/// Young's modulus of the reference ice [Pa].
pub const ICE_E: f64 = 9.0e9;
/// Poisson's ratio of the reference ice.
pub const ICE_NU: f64 = 0.33;

/// Contact modulus of a rigid runner on the reference ice [Pa].
pub fn contact_modulus() -> f64 {
    ICE_E / (1.0 - ICE_NU * ICE_NU)
}

/// A hull on a half-space of reference ice under a central load, free to tilt, on a flat track.
pub fn on_half_space(underside: impl Underside + 'static, fz: f64) -> Problem {
    let runner = Runner::rigid(Arc::new(underside));
    let ice = Ice::half_space(ICE_E, ICE_NU);
    Problem::new(runner, ice, Load::central(fz, Tilt::Free))
}

/// A hull given by a formula.
pub struct Formula<F> {
    /// Height at (x, y) [m].
    pub height: F,
    /// `[x_min, x_max, y_min, y_max]` [m].
    pub extent: [f64; 4],
    /// Mirror planes that the solver may use.
    pub symmetric: [bool; 2],
}

impl<F: Fn(f64, f64) -> f64 + Send + Sync> Underside for Formula<F> {
    fn height(&self, x: f64, y: f64) -> f64 {
        (self.height)(x, y)
    }

    fn extent(&self) -> [f64; 4] {
        self.extent
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        self.symmetric
    }
}
