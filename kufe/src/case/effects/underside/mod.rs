//! Undersides of runners with a change of their height.

mod shaped;
mod turned;

pub(super) use shaped::Shaped;
pub(super) use turned::{About, turn};
