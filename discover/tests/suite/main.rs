//! Searches of data with known missing effects, and without any.

mod boundary;
mod campaign;
mod covariates;
mod hidden_effects;
mod misaligned;
mod next_runs;
mod real_data;
mod sessions;
mod trajectory;
mod walls;
