//! alpha_measured = alpha - tau dalpha/dt to first order. Unit of tau: s. Signature: the slip rate. Confounders: relaxation length (which goes with 1/v
//! and acts on steering too). Source: first-order sensor dynamics.

use super::{Column, Effect, Info, Level, Measured, Parameter};

/// See the module.
pub struct SlipLag;

static INFO: Info = Info {
    name: "slip-lag",
    summary: "the slip angle is late",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("time_s", "s", -0.2, 0.5, 0.002)],
    needs: &[Column::Slip],
    decides: "the sensor's clock against the gyroscope's on a shaken sled",
};

impl Effect for SlipLag {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn correct(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip += parameters[0] * measured.slip_rate;
    }

    fn disturb(&self, parameters: &[f64], measured: &mut Measured) {
        measured.slip -= parameters[0] * measured.slip_rate;
    }
}
