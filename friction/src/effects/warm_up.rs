//! mu' = mu (1 + k exp(-t / tau)). k is a pure number, tau [s] the time in which the steel's surface settles.
//! Signature: over time from the start. Confounders: speed, distance and slope, tied to time on one track.
//! Source: E. Lozowski, K. Szilder, S. Maw, A model of ice friction for a speed skate blade, Sports Eng. 16 (2013) 239-253 (heat into the blade).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct WarmUp;

static INFO: Info = Info {
    name: "warm-up",
    summary: "friction is higher until the runner has warmed up",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("excess", "", -0.9, 10.0, 0.1),
        Parameter::setting("time_s", "s", 0.1, 1000.0, 10.0),
    ],
    needs: &[Column::Time],
    decides: "runs with preheated and with cold steel, and a start further down the track",
};

impl Effect for WarmUp {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (1.0 + parameters[0] * (-at.t / parameters[1]).exp())
    }
}
