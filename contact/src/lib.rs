//! Frictionless contact of a runner on ice.
//!
//! | type | what it is |
//! |---|---|
//! | [`Problem`] | runner, ice, track and load |
//! | [`Solution`] | pressure field, figures, history |

pub mod case;
mod error;
mod problem;
mod solution;

pub use error::Error;
pub use problem::{Foundation, Ice, Load, Problem, Runner, Tilt};
pub use solution::{Iterate, Solution, SurfaceField, VolumeField};
