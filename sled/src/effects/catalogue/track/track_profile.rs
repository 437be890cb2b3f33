//! The surveyed profile is off at places, downhill positive: the same in every run, a random effect with the stated survey deviation.
//!
//! Rough ice looks alike where no accelerometer is used.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "track-profile",
        summary: "the profile of the track is off at places",
        formula: "slope + k on a stretch, downhill positive",
        signature: "by place, in the derivative of the speed alone",
        acts_on: &[ActsOn::Track],
        parameters: &[
            Parameter::amplitude("offset_rad", "rad", -0.05, 0.05, 0.001),
            Parameter::FROM,
            Parameter::TO,
        ],
        needs: &[Column::Slope, Column::Distance],
        judged: Judged::ByProfile,
        looks_like: &["slope", "asperities"],
        decides: "a survey of the track",
        source: "mixed models with a random profile: N.M. Laird, J.H. Ware, Biometrics 38 (1982) 963-974",
        ..Info::NEW
    },
    on_slope: Some(|p, s| if (p[1]..p[2]).contains(&s) { p[0] } else { 0.0 }),
    example: Example {
        parameters: &[0.002, 100.0, 200.0],
        given: &[("slope_rad", 0.05), ("s_m", 150.0)],
        gives: ("slope_rad", 0.052),
    },
    ..Effect::NEW
};
