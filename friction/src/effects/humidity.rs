//! mu' = mu (1 + k (h - h_ref)), h the relative humidity. Unit of k: 1/%. Frost grows from humid air and roughens the ice (k > 0).
//! Signature: a level from session to session. Confounders: temperature.
//! Source: A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, Physics of ice friction, J. Appl. Phys. 107 (2010) 081101.

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Humidity;

static INFO: Info = Info {
    name: "humidity",
    summary: "friction changes with the humidity of the air",
    level: Level::Session,
    parameters: &[
        Parameter::amplitude("slope_per_pct", "1/%", -0.05, 0.05, 0.002),
        Parameter::setting("reference_pct", "%", 0.0, 100.0, 70.0),
    ],
    needs: &[Column::Humidity],
    decides: "sessions of equal ice temperature and different humidity",
};

impl Effect for Humidity {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (1.0 + parameters[0] * (at.humidity_pct - parameters[1]))
    }
}
