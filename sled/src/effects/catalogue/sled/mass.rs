//! The sled is heavier or lighter than stated: forces from accelerations grow with the mass, moments with the stated inertias do not.
//!
//! The cornering stiffnesses take up a common factor.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "mass",
        summary: "the sled is heavier or lighter than stated",
        formula: "m + dm",
        signature: "the balance of side force and yaw moment",
        acts_on: &[ActsOn::Sled],
        parameters: &[Parameter::amplitude("excess_kg", "kg", -300.0, 600.0, 5.0)],
        needs: &[Column::VerticalAcceleration],
        looks_like: &["yaw-inertia", "slip-scale"],
        decides: "the sled on a scale",
        source: "Newton's second law",
        ..Info::NEW
    },
    on_sled: Some(|p, sled| sled.mass += p[0]),
    example: Example {
        parameters: &[15.0],
        given: &[("mass_kg", 390.0)],
        gives: ("mass_kg", 405.0),
    },
    ..Effect::NEW
};
