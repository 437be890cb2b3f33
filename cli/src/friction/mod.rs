//! Friction of a runner, and its fit to experiments and gliding runs.

mod command;
mod failure;
mod fit;
pub mod icehouse;
mod point;
mod sliding;

pub use command::{Args, run};
