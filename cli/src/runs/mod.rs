//! Recorded runs: simulated, fitted, compared with the model, and searched for missing effects.

mod arguments;
pub mod discover;
pub mod evaluate;
mod files;
pub mod fit;
pub mod simulate;
pub mod validate;

pub use files::run_format;
