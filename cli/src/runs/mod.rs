//! Recorded runs: simulated, fitted, compared with the model, and searched for missing effects.

mod arguments;
pub mod discover;
pub mod evaluate;
mod files;
pub mod fit;
pub mod simulate;
pub mod validate;
mod viewer;

pub use files::run_format;
pub use viewer::{all_runs, viewer_page, write_view};
