//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod hull_error;
mod pressed;
mod result;
mod runner;

pub use pressed::{Pressed, press, press_with};
pub use runner::runner_keys;
