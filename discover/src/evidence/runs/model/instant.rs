//! One sample of a run as a model sees it.

use kufe_sled::effects::{self, Signals};
use kufe_sled::{Balance, LawForces, Vehicle};

/// One sample: its balance, the base laws there and what effects see.
#[derive(Clone, Copy)]
pub struct Instant {
    /// What the effects see.
    pub seen: effects::State,
    pub(super) balance: Balance,
    pub(super) laws: LawForces,
    pub(super) signals: Signals,
}

impl Instant {
    /// A balance with its base laws and the signals that it is made of.
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
