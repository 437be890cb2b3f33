//! mu' = mu + k rho A v^2 / (2 F_z): a relative error k of the air density. Signature: v^2, exactly that of the drag area in one session.
//! Confounders: drag area. Source: ideal gas law, specific gas constant of air 287.05 J/(kg K).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct AirDensity;

static INFO: Info = Info {
    name: "air-density",
    summary: "the air density is not the computed one",
    level: Level::Sample,
    parameters: &[Parameter::amplitude("factor", "", -0.5, 0.5, 0.02)],
    needs: &[Column::Speed, Column::Load],
    decides: "a barometer beside the track",
};

impl Effect for AirDensity {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        if parameters[0] == 0.0 {
            return mu;
        }
        mu + 0.5 * parameters[0] * at.air_density * at.drag_area * at.v * at.v / at.fz.max(1.0)
    }
}
