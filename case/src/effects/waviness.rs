//! z' = z + a cos(2 pi x / 0.05 m): waves along the track of 50 mm length and amplitude a [m]. Signature: the pressure modulated along the runner.
//! Confounders: rocker radius, for waves longer than the contact. Source: H.M. Westergaard, J. Appl. Mech. 6 (1939) 49-53.

use std::sync::Arc;

use super::shaped::Shaped;
use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct Waviness;

static INFO: Info = Info {
    name: "waviness",
    key: "amplitude_m",
    unit: "m",
    low: -1.0e-4,
    high: 1.0e-4,
    typical: 1.0e-6,
    decides: "the ice seen under grazing light",
};

impl Effect for Waviness {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        let number = std::f64::consts::TAU / 0.05;
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x: f64, _, height| height + value * ((number * x).cos() - 1.0),
            keeps: [true, true],
        });
    }
}
