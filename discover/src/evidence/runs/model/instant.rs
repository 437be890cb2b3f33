//! One sample of a run in a model.

use kufe_sled::effects::{self, Signals};
use kufe_sled::{Balance, LawForces, Vehicle};

/// One sample: its balance, the base laws, and the state for effects.
#[derive(Clone, Copy)]
pub struct Instant {
    /// The state that effects are evaluated at.
    pub seen: effects::State,
    pub(super) balance: Balance,
    pub(super) laws: LawForces,
    pub(super) signals: Signals,
}

impl Instant {
    /// A balance with its base laws and the signals that it was computed from.
    pub(super) fn new(
        vehicle: &Vehicle,
        balance: Balance,
        laws: LawForces,
        signals: &Signals,
    ) -> Self {
        Self {
            seen: balance.seen(vehicle, laws.load_n),
            balance,
            laws,
            signals: *signals,
        }
    }
}
