//! alpha_measured = (1 + k) alpha. k is a pure number. Signature: the slip at the sensor, but not the part that yaw rate and steering add at the axles.
//! Confounders: the cornering stiffness where steering is small; noise of the slip angle. Source: scale-factor error, IEEE Std 1293-2018.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct SlipScale;

static INFO: Info = Info {
    name: "slip-scale",
    summary: "the slip angle is read too large or too small",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("factor", "", -0.5, 1.0, 0.02)],
    needs: &[Column::Slip],
    decides: "the sensor turned by a known angle",
};

impl Effect for SlipScale {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip /= 1.0 + parameters[0];
        measured.slip_rate /= 1.0 + parameters[0];
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip *= 1.0 + parameters[0];
        measured.slip_rate *= 1.0 + parameters[0];
    }
}
