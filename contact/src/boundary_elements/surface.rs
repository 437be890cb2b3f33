//! What is pressed, where that is a half-space or layers, and why a contact has no second answer.

use crate::boundary_elements::layers::Layer;
use crate::{Foundation, Problem};

/// Why the contact plane alone has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotChecked {
    /// A bounded elastic runner: its bending is no half-space's.
    #[error("the runner is elastic and has ends")]
    ElasticRunner,
    /// A layer of less than a twelfth of a cell's size.
    #[error("the ice is too thin for the contact's cells")]
    ThinLayer,
    /// A peak of pressure no wider than a few cells, as at the ends of a runner.
    #[error("the pressure's peak is narrower than the cells")]
    NarrowPeak,
    /// The hull lies in the ice beyond the cells, too: a second patch, or an end that touches.
    #[error("the runner touches elsewhere too")]
    Elsewhere,
    /// The patch or its set does not settle.
    #[error("the contact set does not settle")]
    NotSettled,
}

/// The two bodies' surfaces as one that gives for both.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// 1 / E* of both as half-spaces [1/Pa].
    pub compliance: f64,
    /// The ice and what it stands on, from the top down; empty for a half-space.
    pub layers: Vec<Layer>,
}

impl Surface {
    /// The surface that the problem states.
    pub fn of(problem: &Problem) -> Result<Self, NotChecked> {
        let ice = &problem.ice;
        if let Some(elastic) = &problem.runner.elastic {
            let unbounded = problem.runner.underside.extent();
            if elastic.solid.is_some() || unbounded.iter().any(|end| end.is_finite()) {
                return Err(NotChecked::ElasticRunner);
            }
        }
        let top = |thickness: f64| Layer {
            youngs_modulus: ice.youngs_modulus,
            poissons_ratio: ice.poissons_ratio,
            thickness,
        };
        let layers = match ice.foundation {
            Foundation::HalfSpace => Vec::new(),
            Foundation::RigidBed { thickness } => vec![top(thickness)],
            Foundation::ElasticBed { thickness, bed } => vec![
                top(thickness),
                Layer {
                    youngs_modulus: bed.youngs_modulus,
                    poissons_ratio: bed.poissons_ratio,
                    thickness: bed.thickness,
                },
            ],
        };
        Ok(Surface {
            compliance: problem.compliance(),
            layers,
        })
    }
}
