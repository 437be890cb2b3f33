//! Small CSV tables of numbers and names; errors state the cell.

use std::path::Path;

use kufe_files::{TABLE_TEXT, column_names, line_of_row, row_error};

use crate::error::{Error, Result};

/// Largest table [bytes]: some 500,000 rows.
const MAX_BYTES: u64 = 1 << 25;

/// A CSV table as text.
#[derive(Clone, Debug)]
pub struct Table {
    pub file: String,
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// Lines of the rows in the file.
    pub lines: Vec<u64>,
}

impl Table {
    /// Reads a CSV file with a header.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read or is ragged.
    pub fn read(path: &Path) -> Result<Self> {
        let refused = |reason: &dyn std::fmt::Display| Error::file(path, reason);
        let text = kufe_files::read_regular(path, MAX_BYTES).map_err(|e| refused(&e))?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text.as_slice());
        let cells = reader.byte_headers().map_err(|e| refused(&e))?;
        let header = column_names(cells.iter());
        let header = header.map_err(|what| refused(&format!("{what}; expected {TABLE_TEXT}")))?;
        if let Some(twice) = (0..header.len()).find(|k| header[..*k].contains(&header[*k])) {
            let what = format!("column `{}` is given twice; expected once", header[twice]);
            return Err(refused(&what));
        }
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|e| refused(&row_error(&text, &e)))?;
            lines.push(line_of_row(&text, &record));
            rows.push(record.iter().map(str::to_owned).collect());
        }
        if rows.is_empty() {
            return Err(refused(&"no rows; expected at least one"));
        }
        Ok(Self {
            file: path.display().to_string(),
            header,
            rows,
            lines,
        })
    }

    /// Index of a column.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.header.iter().position(|name| name == column)
    }

    /// Whether a column is present and not constant.
    pub fn varies(&self, column: &str) -> bool {
        let differs = |at: usize| self.rows.iter().any(|row| row[at] != self.rows[0][at]);
        self.place(column).is_some_and(differs)
    }

    /// Cells of a column.
    ///
    /// # Errors
    /// [`Error::MissingColumn`].
    pub fn texts(&self, column: &str) -> Result<Vec<String>> {
        let at = self.place(column);
        let at = at.ok_or_else(|| self.missing(column, ""))?;
        Ok(self.rows.iter().map(|row| row[at].clone()).collect())
    }

    /// A column of numbers within bounds.
    ///
    /// # Errors
    /// [`Error::MissingColumn`], [`Error::Cell`] with row, column, value and bounds.
    pub fn numbers(&self, column: &str, low: f64, high: f64) -> Result<Vec<f64>> {
        self.texts(column)?
            .into_iter()
            .enumerate()
            .map(|(index, text)| match text.parse::<f64>() {
                Ok(value) if value >= low && value <= high => Ok(value),
                _ => Err(Error::Cell {
                    file: self.file.clone(),
                    row: self.lines[index],
                    column: column.to_owned(),
                    found: text,
                    expected: format!("a number from {low} to {high}"),
                }),
            })
            .collect()
    }

    /// Numbers of a column that may be absent: it then has this value in all rows.
    ///
    /// # Errors
    /// [`Error::Cell`].
    pub fn numbers_or(&self, column: &str, low: f64, high: f64, absent: f64) -> Result<Vec<f64>> {
        match self.place(column) {
            None => Ok(vec![absent; self.rows.len()]),
            Some(_) => self.numbers(column, low, high),
        }
    }

    /// The error of a missing column, which is needed for this reason.
    pub fn missing(&self, column: &str, reason: &str) -> Error {
        Error::MissingColumn {
            file: self.file.clone(),
            column: column.to_owned(),
            found: self.header.join(", ") + reason,
        }
    }
}
