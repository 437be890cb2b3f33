//! E' = E (1 + k). k is a pure number. Signature: peak pressure up, area down, alike at all loads. Confounders: runner compliance (exactly, for a rigid
//! runner in the model), sensor gain. Source: E.M. Schulson, P. Duval, Creep and Fracture of Ice (2009).

use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct IceModulus;

static INFO: Info = Info {
    name: "ice-modulus",
    key: "factor",
    unit: "",
    low: -0.9,
    high: 9.0,
    typical: 0.1,
    decides: "the speed of sound in the ice",
};

impl Effect for IceModulus {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        problem.ice.youngs_modulus *= 1.0 + value;
    }
}
