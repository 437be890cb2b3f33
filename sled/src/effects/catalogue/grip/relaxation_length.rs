//! The side force follows the slip after a distance: sigma/v dalpha'/dt + alpha' = alpha, the force being that of alpha', to first order in
//! how far alpha' is behind.
//!
//! A lag of the slip sensor does not depend on speed.

use crate::effects::law::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "relaxation-length",
        summary: "the side force follows the slip after a distance",
        formula: "F_y - (sigma/v) dF_y/dalpha dalpha'/dt",
        signature: "slip rate over speed",
        acts_on: &[ActsOn::Across],
        parameters: &[Parameter::amplitude("length_m", "m", -5.0, 10.0, 0.05)],
        needs: &[Column::Slip],
        form: Form::FirstOrder,
        looks_like: &["slip-lag", "steer-lag"],
        decides: "steering steps at low and at high speed",
        source: "H.B. Pacejka, Tire and Vehicle Dynamics, 3rd ed. (2012), ch. 7",
        ..Info::NEW
    },
    on_forces: Some(|p, at, forces| {
        for runner in 0..2 {
            let lag = p[0] / at.conditions.v.max(1.0);
            forces.across[runner] -= lag * forces.stiffness[runner] * at.slip_rate[runner];
        }
    }),
    relaxes: Some(0),
    example: Example {
        parameters: &[0.5],
        given: &[
            ("fy_f_n", 300.0),
            ("fy_f_n_per_rad", 20000.0),
            ("alpha_f_rad_rate", 0.1),
            ("v_mps", 25.0),
        ],
        gives: ("fy_f_n", 260.0),
    },
    ..Effect::NEW
};
