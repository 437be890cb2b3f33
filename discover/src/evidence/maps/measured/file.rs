//! A table of pressure measurements with the case that it is compared with.

use std::path::Path;

use kufe::case::Case;

use crate::error::Error;
use crate::evidence::maps::measured::rows::{LONGEST_CASE, Row, read};
use crate::procedure::rules::MapRules;

/// Input of a search.
pub struct Measured {
    pub text: String,
    pub rows: Vec<Row>,
    /// Remarks on the rows.
    pub remarks: Vec<String>,
}

impl Measured {
    /// Reads a `pressures.csv`; `model` is the case file to improve.
    ///
    /// # Errors
    /// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`], those of the case.
    pub fn read(path: &Path, model: &Path, rules: &MapRules) -> Result<Self, Error> {
        let text = kufe_files::text_of_regular(model, LONGEST_CASE)
            .map_err(|error| file_error(model, &error))?;
        let case = Case::parse(&text).map_err(|error| file_error(model, &error))?;
        let (rows, remarks) = read(path, (model, &case), rules)?;
        Ok(Self {
            text,
            rows,
            remarks,
        })
    }
}

/// An error in the case file.
pub fn file_error(model: &Path, what: &dyn std::fmt::Display) -> Error {
    Error::File {
        file: model.display().to_string(),
        reason: what.to_string(),
    }
}
