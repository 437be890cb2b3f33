//! mu' = mu (1 + k d), d the distance run on this finish before the run. Unit of k: 1/km. Scratches roughen the polished steel (k > 0).
//! Signature: a level that climbs from run to run. Confounders: temperature and anything that drifts through a session.
//! Source: A.-M. Kietzig, S.G. Hatzikiriakos, P. Englezos, Ice friction: the effects of surface roughness, structure, and hydrophobicity,
//! J. Appl. Phys. 106 (2009) 024303.

use super::{Column, Conditions, Effect, Info, Level, Parameter};

/// See the module.
pub struct Wear;

static INFO: Info = Info {
    name: "wear",
    summary: "friction grows with the distance run on one finish",
    level: Level::Run,
    parameters: &[Parameter::amplitude(
        "slope_per_km",
        "1/km",
        -0.2,
        1.0,
        0.02,
    )],
    needs: &[Column::Wear],
    decides: "a run on freshly finished runners late in the session",
};

impl Effect for Wear {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64 {
        mu * (1.0 + parameters[0] * at.distance / 1000.0)
    }
}
