//! The centre of gravity lies ahead of where it is said to be, by x: axles and sensors are as much further back.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "cg-place",
        summary: "the centre of gravity is not where it is said to be",
        formula: "l_f - x, l_r + x; sensors at - x",
        signature: "the side force times x in the balance of moments, and the loads of the axles",
        acts_on: &[ActsOn::Sled],
        parameters: &[Parameter::amplitude("x_m", "m", -0.5, 0.5, 0.02)],
        needs: &[Column::YawRate],
        looks_like: &["lever-arm", "yaw-inertia", "mass", "accelerometer-scale"],
        decides: "the loads of both axles on scales",
        source: "the balance of moments about the centre of gravity; W.F. Milliken, D.L. Milliken, Race Car Vehicle Dynamics (1995), ch. 18",
        ..Info::NEW
    },
    on_sled: Some(|p, sled| {
        sled.axles[0] -= p[0];
        sled.axles[1] += p[0];
        sled.accelerometer[0] -= p[0];
        sled.slip_sensor -= p[0];
    }),
    example: Example {
        parameters: &[0.05],
        given: &[("l_r_m", 0.88)],
        gives: ("l_r_m", 0.93),
    },
    ..Effect::NEW
};
