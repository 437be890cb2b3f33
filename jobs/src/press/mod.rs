//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod hull_error;
mod prepared;
mod pressed;
mod progress;
mod result;
mod runner;

pub use prepared::Prepared;
pub use pressed::{Pressed, press, press_prepared, press_with};
pub use progress::{percent, progress_line};
pub use runner::runner_keys;
