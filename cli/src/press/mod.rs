//! `kufe press`: one contact problem or a series of them, from its case to its pressure map.

mod command;
mod series;
mod summary;

pub use command::{Args, run};
