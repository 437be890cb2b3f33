//! The one-track sled: forces from motion and from friction, and the air.

pub mod aero;
pub(crate) mod axles;
pub(crate) mod balance;
pub(crate) mod law_forces;
pub(crate) mod laws;
pub(crate) mod left_by;
pub(crate) mod measured;
pub mod one_track;
pub(crate) mod outside;
pub(crate) mod state;
pub(crate) mod transfer;
