//! Lookup tables from their files.

use std::path::Path;

use crate::jobs::failure::Failure;

/// Reads a `.lut` file.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the place in it.
pub fn read_table(path: &Path) -> Result<kufe_lut::Table, Failure> {
    let failed =
        |reason: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {reason}", path.display()));
    let mut file = kufe_files::open_regular(path)
        .map_err(|error| failed(&format!("cannot be read: {error}")))?;
    kufe_lut::Table::read(&mut file).map_err(|error| failed(&error))
}
