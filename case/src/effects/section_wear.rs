//! z' = max(z, z_keel(x) + d): the section is worn to a flat of depth d [m], its edges rounded by
//! max(a, b) = (a + b + sqrt((a - b)^2 + (d/10)^2))/2: wear leaves no kink, under which the pressure would have no bound.
//! Signature: two ridges of pressure at the edges of the flat.
//! How sharp the edges are is not known: between a kink and this rounding the height at an edge differs by d/20, which a fitted
//! depth may take up; its interval holds that, spread evenly. Confounders: hardness (a plateau without ridges). Source: K.L. Johnson, Contact Mechanics (1985), ch. 2.8 (flat punch with rounded edges).

use std::sync::Arc;

use super::shaped::Shaped;
use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct SectionWear;

static INFO: Info = Info {
    name: "section-wear",
    key: "depth_m",
    unit: "m",
    low: 0.0,
    high: 5.0e-4,
    typical: 5.0e-6,
    decides: "a profile of the section",
};

/// Rounding of the flat's edges over its depth.
const ROUNDED: f64 = 0.1;

impl Effect for SectionWear {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn form_error(&self) -> f64 {
        0.5 * ROUNDED / 3.0_f64.sqrt()
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        let keel = problem.runner.underside.clone();
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x, _, height: f64| {
                let flat = keel.height(x, 0.0) + value;
                0.5 * (height + flat + (height - flat).hypot(ROUNDED * value))
            },
            keeps: [true, true],
        });
    }
}
