//! The catalogue against its own statements, and effects that a person adds.

mod acting;
mod catalogue;
mod example;
mod own;
mod sensors;
mod state;
mod tables;
mod written;
