//! Frictionless contact of a runner on ice.
//!
//! | type | what it is |
//! |---|---|
//! | [`Problem`] | runner, ice, track and load |
//! | [`Options`] | accuracy and limits |
//! | [`solve`] | problem in, solution out |
//! | [`Solution`] | pressure field, figures, history |

mod body;
pub mod case;
mod discretise;
pub mod effects;
mod error;
mod far_field;
mod gap;
mod grading;
mod hertz;
mod level;
mod measure;
mod motion;
mod options;
mod plain;
mod problem;
mod psor;
mod runner_body;
mod solution;
mod solve;
mod stretch;
mod surface;
mod vector;
mod window;

pub use error::Error;
pub use hertz::{Hertz, hertz};
pub use options::{Method, Options};
pub use problem::{ElasticRunner, Foundation, Ice, Load, Problem, Runner, Tilt};
pub use solution::{Iterate, RunnerField, Solution, SurfaceField, VolumeField};
pub use solve::solve;
