//! z' = z + k x^2 / 2: the rocker's curvature 1/R is off by k. Unit: 1/m. Signature: the map longer or shorter along the runner. Confounders: the track's
//! vertical curvature, which adds to it. Source: H. Hertz (1881), by K.L. Johnson, Contact Mechanics (1985), ch. 4.

use std::sync::Arc;

use super::shaped::Shaped;
use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct RockerRadius;

static INFO: Info = Info {
    name: "rocker-radius",
    key: "curvature_1pm",
    unit: "1/m",
    low: -0.2,
    high: 0.2,
    typical: 0.003,
    decides: "a straightedge with feeler gauges",
};

impl Effect for RockerRadius {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        problem.runner.underside = Arc::new(Shaped {
            inner: problem.runner.underside.clone(),
            change: move |x, _, height| height + 0.5 * value * x * x,
            keeps: [true, true],
        });
    }
}
