//! The one-track sled: forces from motion and from friction, and the air.

pub mod aero;
pub(crate) mod balance;
pub mod one_track;
pub(crate) mod outside;
pub(crate) mod state;
