//! F_x += -k rho A v^2 / 2: a relative error k of the air density. Signature: v^2, that of the drag area within one session. Confounders: drag area.
//! Source: ideal gas law with the specific gas constant of air, 287.05 J/(kg K).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct AirDensity;

static INFO: Info = Info {
    name: "air-density",
    summary: "the air density is not the computed one",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("factor", "", -0.5, 0.5, 0.02)],
    needs: &[Column::Speed],
    decides: "a barometer beside the track",
};

impl Effect for AirDensity {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let c = &at.conditions;
        forces.body_along -= 0.5 * parameters[0] * c.air_density * c.drag_area * c.v * c.v;
    }
}
