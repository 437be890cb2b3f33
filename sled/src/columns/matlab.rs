//! Columns of numbers in MATLAB v5 files: one vector a variable, named like the column.

use matfile::NumericData;

use crate::columns::{Columns, collect};
use crate::error::Error;

/// Reads every real vector (1 x n or n x 1) with more than one element; other variables are left out.
///
/// Vectors of double and single precision are safe; the parser refuses some files with integer arrays as a whole.
///
/// # Errors
/// [`Error::File`] where the file is no MATLAB v5 file (v7.3 is HDF5 and not read).
pub fn read_matlab(reader: impl std::io::Read, file: &str) -> Result<Columns, Error> {
    let parsed = matfile::MatFile::parse(reader).map_err(|error| {
        Error::file(
            file,
            format!("{error} (expected MATLAB v5; save with -v6 or -v7)"),
        )
    })?;
    let vectors = parsed.arrays().iter().filter_map(|array| {
        let length: usize = array.size().iter().product();
        let vector = array.size().iter().filter(|n| **n != 1).count() == 1;
        let values = numbers(array.data())?;
        (vector && length > 1 && values.len() == length).then(|| (array.name().to_string(), values))
    });
    collect(vectors, file)
}

fn numbers(data: &NumericData) -> Option<Vec<f64>> {
    macro_rules! real {
        ($real:expr, $imag:expr) => {
            $imag
                .is_none()
                .then(|| $real.iter().map(|v| *v as f64).collect())
        };
    }
    match data {
        NumericData::Int8 { real, imag } => real!(real, imag),
        NumericData::UInt8 { real, imag } => real!(real, imag),
        NumericData::Int16 { real, imag } => real!(real, imag),
        NumericData::UInt16 { real, imag } => real!(real, imag),
        NumericData::Int32 { real, imag } => real!(real, imag),
        NumericData::UInt32 { real, imag } => real!(real, imag),
        NumericData::Int64 { real, imag } => real!(real, imag),
        NumericData::UInt64 { real, imag } => real!(real, imag),
        NumericData::Single { real, imag } => real!(real, imag),
        NumericData::Double { real, imag } => real!(real, imag),
    }
}
