//! The accelerometer stands at the stated position plus (dx, 0, dz). Unit: m. Signature: yaw acceleration (dx), roll acceleration (dz), in the lateral
//! acceleration alone. Confounders: noise of the slip angle, which attenuates forces that the yaw acceleration then shows. Source: rigid-body kinematics.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct LeverArm;

static INFO: Info = Info {
    name: "lever-arm",
    summary: "the accelerometer is not where it is said to be",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("x_m", "m", -1.5, 1.5, 0.02),
        Parameter::amplitude("z_m", "m", -1.5, 1.5, 0.02),
    ],
    needs: &[Column::RollRate],
    decides: "the sensor's place measured with a tape",
};

impl Effect for LeverArm {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.accelerometer[0] += parameters[0];
        measured.accelerometer[2] += parameters[1];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.accelerometer[0] += parameters[0];
        measured.accelerometer[2] += parameters[1];
    }
}
