//! Recorded runs and friction experiments, from their files to what a model lacks.

mod align;
mod corpus;
mod damaged;
mod discover_campaign;
mod discover_experiments;
mod discover_pressures;
mod discover_runs;
mod discover_wrong;
mod experiments;
mod friction;
mod gaps;
mod imported;
mod replay;
mod sled;
mod thresholds;
