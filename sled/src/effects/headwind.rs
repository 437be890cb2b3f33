//! F_x += -rho A ((v + w)^2 - v^2) / 2, w [m/s] against the motion. Signature: v. Confounders: drag area, speed.
//! Source: S.F. Hoerner, Fluid-Dynamic Drag (1965).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct Headwind;

static INFO: Info = Info {
    name: "headwind",
    summary: "a wind along the track",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("speed_mps", "m/s", -15.0, 15.0, 0.5)],
    needs: &[Column::Speed],
    decides: "an anemometer at the track",
};

impl Effect for Headwind {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let c = &at.conditions;
        let w = parameters[0];
        forces.body_along -= 0.5 * c.air_density * c.drag_area * (2.0 * c.v + w) * w;
    }
}
