//! `kufe press`: one contact problem or a series of them, from its case to its pressure map.

mod args;
mod command;
mod files;
mod held;
mod mat;
mod series;
mod sliding;
mod summary;

pub use args::Args;
pub use command::run;
