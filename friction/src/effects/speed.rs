//! mu' = mu (v / v_ref)^n. n is a pure number: -1/2 for frictional heating with a dry fraction, +1/2 for a sheared film. Signature: over speed.
//! Confounders: drag area, warm-up and slope, since speed, time and distance run together on one track.
//! Source: D.C.B. Evans, J.F. Nye, K.J. Cheeseman, The kinetic friction of ice, Proc. R. Soc. A 347 (1976) 493-512;
//! J.J. de Koning, G. de Groot, G.J. van Ingen Schenau, Ice friction during speed skating, J. Biomechanics 25 (1992) 565-571.

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Speed;

static INFO: Info = Info {
    name: "speed",
    summary: "friction changes with speed",
    level: Level::Sample,
    parameters: &[
        Parameter::amplitude("exponent", "", -1.5, 1.5, 0.1),
        Parameter::setting("reference_mps", "m/s", 1.0, 60.0, 25.0),
    ],
    needs: &[Column::Speed],
    decides: "runs from a lower start, or a glide on a flat rink with the drag area varied",
};

impl Effect for Speed {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (at.v.max(0.1) / parameters[1]).powf(parameters[0])
    }
}
