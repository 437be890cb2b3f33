//! F_x += -rho dA v^2 / 2: an error dA [m2] of the drag area C_x A_x. Signature: v^2. Confounders: speed, warm-up, air density, headwind.
//! Source: S.F. Hoerner, Fluid-Dynamic Drag (1965).

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct DragArea;

static INFO: Info = Info {
    name: "drag-area",
    summary: "the drag area is not the stated one",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("cda_m2", "m2", -0.5, 0.5, 0.01)],
    needs: &[Column::Speed],
    decides: "a wind tunnel, or runs at one speed with a changed drag area",
};

impl Effect for DragArea {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let c = &at.conditions;
        forces.body_along -= 0.5 * c.air_density * parameters[0] * c.v * c.v;
    }
}
