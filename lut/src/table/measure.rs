//! How well a table interpolates, measured at its checks.

use crate::error::Error;
use crate::table::layered::Layered;
use crate::table::mode::Mode;
use crate::table::nodes::{Check, Table};
use crate::table::quantity::Quantity;
use crate::table::solved::Point;

/// Interpolation error of one quantity in one mode, measured at [`Table::checks`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Largest error relative to the solved value.
    pub max: f64,
    /// Root of the mean square of the relative errors.
    pub rms: f64,
    /// Where the largest one is.
    pub at: Point,
}

impl Table {
    /// Interpolation error measured at the checks; `None` where there are none.
    ///
    /// # Errors
    /// As [`Layered::new`].
    pub fn interpolation_error(
        &self,
        quantity: Quantity,
        mode: Mode,
    ) -> Result<Option<Measured>, Error> {
        let mut lookup: Option<(Option<f64>, Layered)> = None;
        let mut worst: Option<Measured> = None;
        let mut squares = 0.0;
        for check in self.checks() {
            let radius = check.point.rocker_radius;
            if lookup.as_ref().is_none_or(|(of, _)| *of != radius) {
                lookup = Some((radius, Layered::new(self, quantity, mode, radius)?));
            }
            let Some((_, lookup)) = &lookup else { continue };
            let Some(error) = relative_error(lookup, check, quantity) else {
                continue;
            };
            squares += error * error;
            if worst.is_none_or(|worst| error > worst.max) {
                worst = Some(Measured {
                    max: error,
                    rms: 0.0,
                    at: check.point,
                });
            }
        }
        Ok(worst.map(|worst| Measured {
            rms: (squares / self.checks().len() as f64).sqrt(),
            ..worst
        }))
    }
}

/// Error of an interpolated value relative to the solved one; where that is 0, the plain difference. `None` where the contact
/// has no such quantity.
pub(crate) fn relative_error(lookup: &Layered, check: &Check, quantity: Quantity) -> Option<f64> {
    let truth = check.solved.get(quantity)?;
    let at = &check.point;
    let [speed, ice_c] = [at.speed, at.ice_c].map(|value| value.unwrap_or(f64::NAN));
    let value = lookup.at(at.fz, at.curvature, speed, ice_c).value;
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    Some((value - truth).abs() / scale)
}
