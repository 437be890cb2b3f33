//! The track is steeper or flatter than stated, downhill positive. An accelerometer does not feel it; the speed does.
//!
//! A glide takes it for less friction, exactly, unless both directions are run.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "slope",
        summary: "the track is steeper or flatter than stated",
        formula: "slope + k, downhill positive",
        signature: "a constant in the difference of the derivative of the speed and the accelerometer",
        acts_on: &[ActsOn::Track, ActsOn::Friction],
        parameters: &[Parameter::amplitude(
            "offset_rad",
            "rad",
            -0.05,
            0.05,
            0.0005,
        )],
        needs: &[Column::Slope],
        judged: Judged::BySlope,
        experiments: Experiments::Never(
            "is the same as another level of friction unless both directions are run",
        ),
        looks_like: &["accelerometer-bias", "accelerometer-tilt"],
        decides: "a levelled track, or runs in both directions",
        source: "the paired uphill and downhill glides of the ice-house experiments (a slope of about 0.12 degrees averages out)",
        ..Info::NEW
    },
    on_friction: Some(|p, mu, _| mu - p[0]),
    on_slope: Some(|p, _| p[0]),
    example: Example {
        parameters: &[0.002],
        given: &[("slope_rad", 0.05)],
        gives: ("slope_rad", 0.052),
    },
    ..Effect::NEW
};
