//! Lookup tables: the file that asks for one, and the contacts that fill it.

mod fill;
mod solver;
mod wanted;

use std::path::Path;

pub use fill::{Filled, fill};
pub use solver::{SolveError, Solver};
pub use wanted::{Wanted, schema};

use crate::Failure;

/// Reads a `.lut` file.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the place in it.
pub fn read_table(path: &Path) -> Result<kufe_lut::Table, Failure> {
    let told =
        |reason: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {reason}", path.display()));
    let mut file =
        std::fs::File::open(path).map_err(|error| told(&format!("cannot be read: {error}")))?;
    kufe_lut::Table::read(&mut file).map_err(|error| told(&error))
}
