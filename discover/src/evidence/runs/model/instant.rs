//! One sample of a run in a model.

use kufe_sled::effects::{self, Active, Forces, Signals};
use kufe_sled::{Balance, LawForces, Vehicle};

use crate::evidence::runs::model::residual_model::BALANCES;

/// One sample: its balance, the base laws, the state for effects, and the forces.
#[derive(Clone, Copy)]
pub struct Instant {
    /// The state that effects are evaluated at.
    pub seen: effects::State,
    pub(super) balance: Balance,
    pub(super) laws: LawForces,
    pub(super) signals: Signals,
    /// Forces of the base laws with the model's effects.
    pub(super) forces: Forces,
}

impl Instant {
    /// A balance with its base laws and the signals that it was computed from.
    pub(super) fn new(
        vehicle: &Vehicle,
        balance: Balance,
        laws: LawForces,
        signals: &Signals,
    ) -> Self {
        let seen = balance.seen(vehicle, laws.load_n);
        let mut forces = laws.forces;
        vehicle.effects.act(&seen, &mut forces);
        Self {
            seen,
            balance,
            laws,
            signals: *signals,
            forces,
        }
    }

    /// Residuals of the longitudinal [N], lateral [N] and yaw [N m] balance.
    pub fn residuals(&self) -> [f64; BALANCES] {
        self.residuals_with_forces(&self.forces)
    }

    /// Residuals with other forces.
    pub(super) fn residuals_with_forces(&self, forces: &Forces) -> [f64; BALANCES] {
        self.balance.residual(forces).values()
    }

    /// Residuals with one more effect on the forces.
    pub(super) fn residuals_with_force_effect(&self, effect: &Active) -> [f64; BALANCES] {
        let mut forces = self.forces;
        effect.act(&self.seen, &mut forces);
        self.residuals_with_forces(&forces)
    }
}
