//! F_y' = F_y (1 + k (T_ice - T_ref)). Unit of k: 1/K. Colder ice is harder and lets the runner cut in less. Signature: a level from session to session.
//! Confounders: anything that drifts with the sessions. Source: L. Poirier, E.P. Lozowski, R.I. Thompson, Ice hardness in winter sports,
//! Cold Reg. Sci. Technol. 67 (2011) 129-134.

use super::{Column, Effect, Forces, Info, Level, Parameter, State};

/// See the module.
pub struct TemperatureGrip;

static INFO: Info = Info {
    name: "temperature-grip",
    summary: "lateral grip changes with the ice temperature",
    level: Level::Session,
    parameters: &[
        Parameter::amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
        Parameter::setting("reference_c", "deg C", -40.0, 0.0, -5.0),
    ],
    needs: &[Column::IceTemperature],
    decides: "sessions at other ice temperatures",
};

impl Effect for TemperatureGrip {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn act(&self, parameters: &[f64], at: &State, forces: &mut Forces) {
        let factor = 1.0 + parameters[0] * (at.conditions.ice_c - parameters[1]);
        for across in &mut forces.across {
            *across *= factor;
        }
    }
}
