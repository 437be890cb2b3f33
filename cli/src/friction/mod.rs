//! Friction of a runner, and its fit to experiments and gliding runs.

mod asked;
mod command;
mod failure;
mod fit;
pub mod icehouse;
mod optimum;
mod optimum_picture;
mod point;
mod sliding;
mod sliding_picture;

pub use command::{Args, run};
