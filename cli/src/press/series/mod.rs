//! A series: lists of loads, radii and tilts, each combination solved in a folder of its own, and one table of all.

mod first_step;
pub mod lists;
mod solve;

pub use solve::run;
