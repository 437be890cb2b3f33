//! Small CSV tables of numbers and names; errors state the cell.

use std::path::Path;

use crate::error::Error;

/// Largest table [bytes]: some 500,000 rows.
const MOST_BYTES: u64 = 1 << 25;

/// A CSV table as text.
#[derive(Clone, Debug)]
pub struct Table {
    pub file: String,
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a CSV file with a header.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read or is ragged.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.display().to_string();
        let file_error = |reason: String| Error::File {
            file: file.clone(),
            reason,
        };
        let text = kufe_files::text_of_regular(path, MOST_BYTES);
        let text = text.map_err(|error| file_error(error.to_string()))?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let header: Vec<String> = reader
            .headers()
            .map_err(|error| file_error(error.to_string()))?
            .iter()
            .map(str::to_owned)
            .collect();
        if let Some(twice) = (0..header.len()).find(|k| header[..*k].contains(&header[*k])) {
            return Err(file_error(format!(
                "column `{}` is given twice; expected once",
                header[twice]
            )));
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| file_error(error.to_string()))?;
            rows.push(record.iter().map(str::to_owned).collect());
        }
        if rows.is_empty() {
            return Err(file_error("no rows; expected at least one".to_owned()));
        }
        Ok(Self { file, header, rows })
    }

    /// Index of a column.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.header.iter().position(|name| name == column)
    }

    /// Cells of a column.
    ///
    /// # Errors
    /// [`Error::MissingColumn`].
    pub fn texts(&self, column: &str) -> Result<Vec<String>, Error> {
        let at = self.place(column).ok_or_else(|| Error::MissingColumn {
            file: self.file.clone(),
            column: column.to_owned(),
            found: self.header.join(", "),
        })?;
        Ok(self.rows.iter().map(|row| row[at].clone()).collect())
    }

    /// A column of numbers within bounds.
    ///
    /// # Errors
    /// [`Error::MissingColumn`], [`Error::Cell`] with row, column, value and bounds.
    pub fn numbers(&self, column: &str, low: f64, high: f64) -> Result<Vec<f64>, Error> {
        self.texts(column)?
            .into_iter()
            .enumerate()
            .map(|(index, text)| match text.parse::<f64>() {
                Ok(value) if value >= low && value <= high => Ok(value),
                _ => Err(Error::Cell {
                    file: self.file.clone(),
                    row: index as u64 + 2,
                    column: column.to_owned(),
                    found: text,
                    expected: format!("a number from {low} to {high}"),
                }),
            })
            .collect()
    }

    /// A column of numbers that may be absent.
    ///
    /// # Errors
    /// [`Error::Cell`].
    pub fn optional(&self, column: &str, low: f64, high: f64) -> Result<Option<Vec<f64>>, Error> {
        match self.place(column) {
            None => Ok(None),
            Some(_) => self.numbers(column, low, high).map(Some),
        }
    }
}
