//! a_measured = a + b along x and along y. Unit: m/s2. Signature: a constant. Confounders: tilt, slope, the level of friction (x); slip and steering offsets (y).
//! Source: IEEE Std 1293-2018, linear single-axis accelerometers.

use super::{Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct AccelerometerBias;

static INFO: Info = Info {
    name: "accelerometer-bias",
    summary: "the accelerometer reads a constant too much",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("x_mps2", "m/s2", -3.0, 3.0, 0.01),
        Parameter::amplitude("y_mps2", "m/s2", -3.0, 3.0, 0.05),
    ],
    needs: &[],
    decides: "the sled at rest on level ice, turned round once",
};

impl Effect for AccelerometerBias {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.acceleration[0] -= parameters[0];
        measured.acceleration[1] -= parameters[1];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.acceleration[0] += parameters[0];
        measured.acceleration[1] += parameters[1];
    }
}
