//! Lookup tables: the file that asks for one, and the contacts that fill it.

mod anchors;
mod best;
mod fill;
mod read;
mod slide;
mod solver;
mod wanted;

pub use fill::{Filled, fill};
pub use read::read_table;
pub use solver::{SolveError, Solver};
pub use wanted::{Wanted, schema};
