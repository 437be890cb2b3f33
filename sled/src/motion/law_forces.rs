//! Forces of the base laws at one instant, with their derivatives.

use crate::effects::Forces;
use crate::friction::LateralDerivatives;

use crate::model::vehicle::{BaseParameter, Vehicle};

/// What the base laws of both runners give, before any effect.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawForces {
    /// Normal force on each runner in its own frame, front and rear [N].
    pub load_n: [f64; 2],
    /// Lateral law of each runner with its derivatives.
    pub lateral: [LateralDerivatives; 2],
    /// The forces; those on the body are 0.
    pub forces: Forces,
}

impl LawForces {
    /// The forces to first order, with a base parameter of the vehicle moved by a share of itself.
    pub fn moved(&self, vehicle: &Vehicle, parameter: BaseParameter, share: f64) -> Forces {
        let mut forces = self.forces;
        let across = &mut forces.across;
        let (front, rear) = (&vehicle.front.lateral, &vehicle.rear.lateral);
        let [by_front, by_rear] = &self.lateral;
        match parameter {
            BaseParameter::Longitudinal => forces.along.iter_mut().for_each(|f| *f *= 1.0 + share),
            BaseParameter::FrontGrip => across[0] += front.mu_zeta * share * by_front.mu_zeta,
            BaseParameter::FrontStiffness => {
                across[0] += front.k_n_per_rad * share * by_front.k_n_per_rad;
            }
            BaseParameter::RearGrip => across[1] += rear.mu_zeta * share * by_rear.mu_zeta,
            BaseParameter::RearStiffness => {
                across[1] += rear.k_n_per_rad * share * by_rear.k_n_per_rad;
            }
        }
        forces
    }
}
