//! One contact problem, from its case to its solution and `result.json`.

mod check;
mod contact;
pub(crate) mod hull_error;
mod progress;

pub use contact::{Contact, Prepared, SolvedContact, press_prepared};
pub use progress::{time_left, with_progress};
