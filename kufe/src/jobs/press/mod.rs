//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod hull_error;
mod left;
mod prepared;
mod pressed;
mod progress;
mod result;
mod runner;

pub use left::time_left;
pub use prepared::Prepared;
pub use pressed::{Pressed, press, press_prepared, press_with};
pub use progress::{percent, with_progress};
pub use runner::runner_keys;
