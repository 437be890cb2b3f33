//! p <= H with 1/H the parameter (0: no bound). Unit: 1/Pa. Signature: a plateau in the middle of the map, growing with load.
//! Confounders: a worn section, film blur. Source: L. Poirier, E.P. Lozowski, R.I. Thompson, Ice hardness in winter sports,
//! Cold Reg. Sci. Technol. 67 (2011) 129-134; K.L. Johnson, Contact Mechanics (1985), ch. 6.

use super::{Effect, Info};
use kufe_contact::Problem;

/// See the module.
pub struct Hardness;

static INFO: Info = Info {
    name: "hardness",
    key: "inverse_per_pa",
    unit: "1/Pa",
    low: 0.0,
    high: 1.0e-6,
    typical: 2.0e-9,
    decides: "an imprint left in the ice after lifting",
};

impl Effect for Hardness {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        let own = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
        problem.ice.hardness = Some(1.0 / (own + value).max(1.0e-12));
    }
}
