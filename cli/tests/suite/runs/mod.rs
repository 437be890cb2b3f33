//! Recorded runs and friction experiments: their files, checks, fits and simulation.

mod align;
mod corpus;
mod damaged;
mod friction;
mod gaps;
mod gather;
mod imported;
mod replay;
mod sled;
mod tables;
mod thresholds;
