//! 1/E*' = (1 + k)/E*: the runner gives k times as much as the ice. k is a pure number, about 0.04 for steel on ice as a block; more where the
//! runner bends. Signature: that of a softer ice. Confounders: ice modulus. Source: K.L. Johnson, Contact Mechanics (1985), ch. 4.2.

use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct RunnerCompliance;

static INFO: Info = Info {
    name: "runner-compliance",
    key: "factor",
    unit: "",
    low: 0.0,
    high: 3.0,
    typical: 0.1,
    decides: "the same runner on a plate of known modulus",
};

impl Effect for RunnerCompliance {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        problem.ice.youngs_modulus /= 1.0 + value;
    }
}
