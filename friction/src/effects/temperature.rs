//! mu' = mu (1 + k (T_ice - T_ref)). Unit of k: 1/K. Friction on ice has a minimum at a few degrees below zero and grows towards cold ice
//! (k < 0) as the melt film thins. Signature: a level from session to session. Confounders: humidity, wear, anything else that drifts with the weather.
//! Source: M. Akkok, C.M. McC. Ettles, S.J. Calabrese, Parameters affecting the kinetic friction of ice, J. Tribology 109 (1987) 552-561;
//! L. Poirier, Ice Friction in the Sport of Bobsleigh, PhD thesis, University of Calgary (2011).

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Temperature;

static INFO: Info = Info {
    name: "temperature",
    summary: "friction changes with the ice temperature",
    level: Level::Session,
    parameters: &[
        Parameter::amplitude("slope_per_k", "1/K", -0.2, 0.2, 0.01),
        Parameter::setting("reference_c", "deg C", -40.0, 0.0, -5.0),
    ],
    needs: &[Column::IceTemperature],
    decides: "sessions at other ice temperatures with the other conditions held",
};

impl Effect for Temperature {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (1.0 + parameters[0] * (at.ice_c - parameters[1]))
    }
}
