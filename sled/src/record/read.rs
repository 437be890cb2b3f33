//! Columns of numbers from CSV, Parquet, MATLAB v5 and MDF 4.

use std::path::Path;

use crate::error::Error;
use crate::record::columns::Columns;
use crate::record::csv::read_csv;
use crate::record::matlab::read_matlab_columns;
use crate::record::mdf4::read_mdf4;
use crate::record::parquet::read_parquet;

/// Reads every numeric column of a file, its format told by the extension (CSV where unknown).
///
/// Text in a column that is not `required` leaves the column out; empty cells and nulls become NaN.
///
/// # Errors
/// [`Error::File`], [`Error::Cell`], [`Error::Column`] for a column given twice.
pub fn read_columns(path: &Path, required: &[&str]) -> Result<Columns, Error> {
    let file = path.display().to_string();
    let extension = path
        .extension()
        .and_then(|extension| extension.to_str())
        .unwrap_or("")
        .to_ascii_lowercase();
    match extension.as_str() {
        "parquet" => read_parquet(open(path)?, &file),
        "mat" => read_matlab_columns(&bytes_of(path)?, &file),
        "mf4" => read_mdf4(path),
        _ => read_csv(open(path)?, required, &file),
    }
}

/// Longest MATLAB file [bytes].
const LONGEST: u64 = 4 << 30;

fn bytes_of(path: &Path) -> Result<Vec<u8>, Error> {
    kufe_files::read_regular(path, LONGEST)
        .map_err(|error| Error::file(&path.display().to_string(), error))
}

fn open(path: &Path) -> Result<std::fs::File, Error> {
    kufe_files::open_regular(path).map_err(|error| Error::file(&path.display().to_string(), error))
}
