//! Lookup tables: the file that specifies a table, and the solver of its points.

mod plan_file;
mod points;
mod solver;
mod spec;

use std::path::Path;

use crate::jobs::failure::{Failure, Located};

pub use plan_file::PlanFile;
pub use points::{PointStore, same_origin};
pub use solver::{FilledTable, Solver, fill};
pub use spec::{TableSpec, schema};

/// Reads a `.lut` file.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the place in it.
pub fn read_table(path: &Path) -> Result<kufe_lut::Table, Failure> {
    let mut file = kufe_files::open_regular(path).in_file(path)?;
    kufe_lut::Table::read(&mut file).in_file(path)
}
