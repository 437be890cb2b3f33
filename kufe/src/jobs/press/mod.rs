//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod hull_error;
mod left;
mod prepared;
mod pressed;
mod progress;
mod result;

pub use left::time_left;
pub use prepared::Prepared;
pub use pressed::{SolvedContact, press, press_prepared, press_with};
pub use progress::{percent, with_progress};
