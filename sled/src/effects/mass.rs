//! m' = m + dm. Unit: kg. Forces from accelerations grow with the mass, the moments with the stated inertias do not. Signature: the balance of side force and
//! yaw moment. Confounders: the cornering stiffnesses, which take up a common factor. Source: Newton's second law.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct Mass;

static INFO: Info = Info {
    name: "mass",
    summary: "the sled is heavier or lighter than stated",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("excess_kg", "kg", -300.0, 600.0, 5.0)],
    needs: &[Column::VerticalAcceleration],
    decides: "the sled on a scale",
};

impl Effect for Mass {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.mass += parameters[0];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.mass += parameters[0];
    }
}
