//! alpha_measured = alpha + b. Unit of b: rad. Signature: a constant side force at both axles. Confounders: steering offset, accelerometer bias and tilt.
//! Source: mounting angle of an optical slip sensor.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct SlipOffset;

static INFO: Info = Info {
    name: "slip-offset",
    summary: "the slip angle has an offset",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("offset_rad", "rad", -0.1, 0.1, 0.0005)],
    needs: &[Column::Slip],
    decides: "a straight run with the steering fixed at zero",
};

impl Effect for SlipOffset {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip -= parameters[0];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip += parameters[0];
    }
}
