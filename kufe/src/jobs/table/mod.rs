//! Lookup tables: the file that specifies one, and the contacts that fill it.

mod anchors;
mod best;
mod fill;
mod plan_file;
mod points;
mod read;
mod slide;
mod solver;
mod spec;

pub use fill::{Filled, fill};
pub use plan_file::PlanFile;
pub use points::{PointStore, same_origin};
pub use read::read_table;
pub use solver::{SolveError, Solver};
pub use spec::{TableSpec, schema};
