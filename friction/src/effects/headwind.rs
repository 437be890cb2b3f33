//! mu' = mu + rho A ((v + w)^2 - v^2) / (2 F_z), w [m/s] against the motion, A the drag area. Signature: v. Confounders: drag area, speed.
//! Source: S.F. Hoerner, Fluid-Dynamic Drag (1965).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Headwind;

static INFO: Info = Info {
    name: "headwind",
    summary: "a wind along the track",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("speed_mps", "m/s", -15.0, 15.0, 0.5)],
    needs: &[Column::Speed, Column::Load],
    decides: "an anemometer, or runs in both directions",
};

impl Effect for Headwind {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        if parameters[0] == 0.0 {
            return mu;
        }
        let w = parameters[0];
        mu + 0.5 * at.air_density * at.drag_area * (2.0 * at.v + w) * w / at.fz.max(1.0)
    }
}
