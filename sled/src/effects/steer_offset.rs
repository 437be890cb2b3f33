//! delta_measured = delta + b. Unit of b: rad. Signature: a constant side force at the front alone. Confounders: slip offset.
//! Source: zero error of an angle sensor.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct SteerOffset;

static INFO: Info = Info {
    name: "steer-offset",
    summary: "the steering angle has an offset",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("offset_rad", "rad", -0.2, 0.2, 0.001)],
    needs: &[Column::Steering],
    decides: "a straight run with the steering clamped",
};

impl Effect for SteerOffset {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.steering -= parameters[0];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.steering += parameters[0];
    }
}
