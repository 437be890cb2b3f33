//! How well a table interpolates, measured at its checks.

use crate::error::Error;
use crate::table::lookup::Lookup;
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
    /// As [`Lookup::new`].
    pub fn interpolation_error(
        &self,
        quantity: Quantity,
        mode: Mode,
    ) -> Result<Option<Measured>, Error> {
        let mut lookup: Option<(Option<f64>, Lookup)> = None;
        let mut worst: Option<Measured> = None;
        let mut squares = 0.0;
        for check in self.checks() {
            let radius = check.point.rocker_radius;
            if lookup.as_ref().is_none_or(|(of, _)| *of != radius) {
                lookup = Some((radius, Lookup::with_rocker(self, quantity, mode, radius)?));
            }
            let Some((_, lookup)) = &lookup else { continue };
            let error = relative_error(lookup, check, quantity);
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

/// Error of an interpolated value relative to the solved one; where that is 0, the plain difference.
pub(crate) fn relative_error(lookup: &Lookup, check: &Check, quantity: Quantity) -> f64 {
    let truth = check.solved.get(quantity);
    let value = lookup.at(check.point.fz, check.point.curvature).value;
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    (value - truth).abs() / scale
}
