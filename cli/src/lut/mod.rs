//! `kufe lut`: lookup tables of contact figures, made, read, exported, and made in pieces.

mod command;
mod export;
mod fill;
mod finish;
mod plan;
mod query;
mod show;

pub use command::{Args, explained, run};
