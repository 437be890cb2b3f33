//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod pressed;
mod result;
mod runner;
mod scan_noise;

pub use pressed::{Pressed, press, press_with};
pub use runner::runner_keys;
