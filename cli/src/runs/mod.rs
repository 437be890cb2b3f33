//! Recorded runs: simulated, fitted, held against the model, and searched for what it lacks.

mod arguments;
pub mod discover;
pub mod evaluate;
pub mod fit;
mod series;
pub mod simulate;
pub mod tables;
pub mod validate;
