//! The contact of one run.

use kufe_sled::WallContact;

/// The contact of a run at one of the places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnContact {
    /// Index of the place.
    pub place: usize,
    pub contact: WallContact,
    /// Standard error of the force \[N\].
    pub error_n: f64,
}
