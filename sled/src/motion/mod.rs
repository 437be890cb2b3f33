//! The one-track sled: forces from motion and from friction, and the air.

pub mod aero;
pub mod one_track;
pub(crate) mod transfer;
