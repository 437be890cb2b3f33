//! Recorded runs and friction experiments, from their files to what a model lacks.

mod discover_experiments;
mod discover_pressures;
mod discover_runs;
mod friction;
mod sled;
