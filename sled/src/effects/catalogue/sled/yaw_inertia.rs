//! The yaw moment of inertia is not the stated one, by a share k of it.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "yaw-inertia",
        summary: "the yaw moment of inertia is not the stated one",
        formula: "J_zz (1 + k)",
        signature: "yaw acceleration, in the balance of moments alone",
        acts_on: &[ActsOn::Sled],
        parameters: &[Parameter::amplitude("factor", "", -0.7, 2.0, 0.05)],
        needs: &[Column::YawRate],
        // Measured: claimed within runs of any kind, it is named in campaigns whose sessions merely differ in grip by 5 %.
        judged: Judged::BeyondTolerance,
        looks_like: &["mass", "yaw-rate-scale", "lever-arm"],
        decides: "the sled swung on a trifilar suspension",
        source: "the balance of angular momentum about the vertical",
        ..Info::NEW
    },
    on_sled: Some(|p, sled| sled.yaw_inertia *= 1.0 + p[0]),
    example: Example {
        parameters: &[0.1],
        given: &[("j_zz_kgm2", 150.0)],
        gives: ("j_zz_kgm2", 165.0),
    },
    ..Effect::NEW
};
