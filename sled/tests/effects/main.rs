//! The catalogue of effects against its descriptions, and user-defined effects.

mod acting;
mod catalogue;
mod example;
mod own;
mod sensors;
mod state;
mod tables;
mod written;
