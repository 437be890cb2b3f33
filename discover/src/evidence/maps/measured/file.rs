//! A table of pressure measurements with the case that it is compared with.

use std::path::Path;

use kufe::case::Case;

use crate::error::Error;
use crate::evidence::maps::measured::rows::{LONGEST_CASE, Row, read};
use crate::procedure::rules::MapRules;

/// What a search is given: the case's text, and its rows as they are read.
pub struct Measured {
    /// The case's text.
    pub text: String,
    /// The rows.
    pub rows: Vec<Row>,
    /// What the reader should know of them.
    pub remarks: Vec<String>,
}

impl Measured {
    /// Reads a `pressures.csv`; `model` is the case file that is to be improved.
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

/// What is wrong with the case's file.
pub fn file_error(model: &Path, what: &dyn std::fmt::Display) -> Error {
    Error::File {
        file: model.display().to_string(),
        reason: what.to_string(),
    }
}
