//! The layer's thickness t' from 1/t' = 1/t + k (a half-space: 1/t = 0). Unit of k: 1/m. Signature: stiffer under large loads, where the contact is
//! as wide as the layer is thick. Confounders: modulus. Source: K.L. Johnson, Contact Mechanics (1985), ch. 5.8.

use super::{Effect, Info};
use kufe_contact::{Foundation, Problem};

/// See the module.
pub struct IceThickness;

static INFO: Info = Info {
    name: "ice-thickness",
    key: "inverse_per_m",
    unit: "1/m",
    low: -19.0,
    high: 5000.0,
    typical: 20.0,
    decides: "a drill hole",
};

impl Effect for IceThickness {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn alter(&self, value: f64, problem: &mut Problem) {
        if value == 0.0 {
            return;
        }
        let own = match problem.ice.foundation {
            Foundation::HalfSpace => 0.0,
            Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                1.0 / thickness
            }
        };
        let inverse = own + value;
        let thickness = 1.0 / inverse;
        problem.ice.foundation = match problem.ice.foundation {
            _ if inverse <= 1.0e-6 => Foundation::HalfSpace,
            Foundation::ElasticBed { bed, .. } => Foundation::ElasticBed { thickness, bed },
            _ => Foundation::RigidBed { thickness },
        };
    }
}
