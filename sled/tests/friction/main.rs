//! The friction laws and their fits against closed forms, samples drawn from known models and the
//! published numbers.

mod film;
mod icehouse;
mod lateral_fit;
mod models;
mod mu_pressure_fit;
