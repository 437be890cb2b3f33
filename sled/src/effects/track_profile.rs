//! slope' = slope + k for from_m <= s < to_m, downhill positive. Unit of k: rad. An error of the surveyed profile, the same in every run; a random effect
//! with the stated survey deviation. Signature: by place, in the speed's derivative alone. Confounders: slope; rough ice where no accelerometer is used.
//! Source: mixed models with a random profile: N.M. Laird, J.H. Ware, Random-effects models for longitudinal data, Biometrics 38 (1982) 963-974.

use super::{Column, Effect, Info, Level, Parameter};

/// See the module.
pub struct TrackProfile;

static INFO: Info = Info {
    name: "track-profile",
    summary: "the profile of the track is off at places",
    level: Level::Track,
    parameters: &[
        Parameter::amplitude("offset_rad", "rad", -0.05, 0.05, 0.001),
        Parameter::setting("from_m", "m", -1.0e5, 1.0e6, 0.0),
        Parameter::setting("to_m", "m", -1.0e5, 1.0e6, 1.0e6),
    ],
    needs: &[Column::Slope, Column::Distance],
    decides: "a survey of the track",
};

impl Effect for TrackProfile {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn slope(&self, parameters: &[f64], s: f64) -> f64 {
        if (parameters[1]..parameters[2]).contains(&s) {
            parameters[0]
        } else {
            0.0
        }
    }
}
