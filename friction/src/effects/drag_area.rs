//! mu' = mu + rho dA v^2 / (2 F_z): what an error dA [m2] of the drag area C_x A_x adds to an apparent friction coefficient.
//! Signature: v^2. Confounders: speed, headwind, air density. Source: S.F. Hoerner, Fluid-Dynamic Drag (1965).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct DragArea;

static INFO: Info = Info {
    name: "drag-area",
    summary: "the drag area is not the stated one",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("cda_m2", "m2", -0.5, 0.5, 0.01)],
    needs: &[Column::Speed, Column::Load],
    decides: "runs at the same speed with a changed drag area, or a wind tunnel",
};

impl Effect for DragArea {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        if parameters[0] == 0.0 {
            return mu;
        }
        mu + 0.5 * at.air_density * parameters[0] * at.v * at.v / at.fz.max(1.0)
    }
}
