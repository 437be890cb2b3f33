//! a_x,measured = a_x - theta a_z, a_y,measured = a_y + phi a_z: the sensor pitched by theta (nose down) and rolled by phi (left side up), small angles [rad].
//! Signature: the vertical acceleration. Confounders: load, bias, slope (exactly opposite on a level track).
//! Source: IEEE Std 1293-2018, misalignment of the input axis.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct AccelerometerTilt;

static INFO: Info = Info {
    name: "accelerometer-tilt",
    summary: "the accelerometer sits askew",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("pitch_rad", "rad", -0.3, 0.3, 0.001),
        Parameter::amplitude("roll_rad", "rad", -0.3, 0.3, 0.003),
    ],
    needs: &[Column::VerticalAcceleration],
    decides: "the sled at rest on level ice; a curve with known load",
};

impl Effect for AccelerometerTilt {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        let z = measured.acceleration[2];
        measured.acceleration[0] += parameters[0] * z;
        measured.acceleration[1] -= parameters[1] * z;
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        let z = measured.acceleration[2];
        measured.acceleration[0] -= parameters[0] * z;
        measured.acceleration[1] += parameters[1] * z;
    }
}
