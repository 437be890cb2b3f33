//! A table of measurements: read once, asked by column, every complaint with file, row and column.

use std::io::Read;

use crate::friction::error::Error;

/// What is done with columns that nobody asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extra {
    /// They are an error: the table is made for this program.
    Refused,
    /// They are kept: the table is a measurement.
    Kept,
}

/// The columns a table must and may have.
pub(crate) struct Columns {
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
    pub extra: Extra,
}

/// A table held as text.
pub(crate) struct Table {
    file: String,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    pub(crate) fn read(file: &str, reader: impl Read, columns: &Columns) -> Result<Self, Error> {
        let unreadable = |error: csv::Error| Error::Unreadable {
            file: file.to_string(),
            reason: error.to_string(),
        };
        let mut csv = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(reader);
        let header: Vec<String> = csv
            .headers()
            .map_err(unreadable)?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_string())
            .collect();
        for (i, name) in header.iter().enumerate() {
            if header[..i].contains(name) {
                return Err(Error::UnknownColumn {
                    file: file.into(),
                    column: format!("{name} (a second time)"),
                    expected: "each column once".into(),
                });
            }
            let known = columns.required.contains(&name.as_str())
                || columns.optional.contains(&name.as_str());
            if !known && columns.extra == Extra::Refused {
                return Err(Error::UnknownColumn {
                    file: file.into(),
                    column: name.clone(),
                    expected: [columns.required, columns.optional].concat().join(", "),
                });
            }
        }
        for name in columns.required {
            if !header.iter().any(|there| there == name) {
                return Err(Error::MissingColumn {
                    file: file.into(),
                    column: (*name).into(),
                    found: match header.join(", ") {
                        empty if empty.is_empty() => "nothing".into(),
                        names => names,
                    },
                    expected: columns.required.join(", "),
                });
            }
        }
        let rows = csv
            .into_records()
            .collect::<Result<Vec<_>, _>>()
            .map_err(unreadable)?;
        Ok(Table {
            file: file.into(),
            header,
            rows,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn header(&self) -> &[String] {
        &self.header
    }

    /// The cell's text; `None` where there is no such column.
    pub(crate) fn text(&self, row: usize, column: &str) -> Option<&str> {
        let place = self.header.iter().position(|name| name == column)?;
        self.rows[row].get(place)
    }

    /// The cell's text, which may not be empty.
    pub(crate) fn name(&self, row: usize, column: &str) -> Result<String, Error> {
        match self.text(row, column) {
            Some(text) if !text.is_empty() => Ok(text.to_string()),
            found => Err(self.bad(row, column, found.unwrap_or("nothing"), "a name")),
        }
    }

    /// The cell as a finite number that `fits`.
    pub(crate) fn number(
        &self,
        row: usize,
        column: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<f64, Error> {
        let text = self.text(row, column).unwrap_or("");
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() && fits(value) => Ok(value),
            _ => Err(self.bad(row, column, text, expected)),
        }
    }

    /// As [`Table::number`]; `None` where the column is absent or the cell empty.
    pub(crate) fn optional(
        &self,
        row: usize,
        column: &str,
        fits: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<Option<f64>, Error> {
        match self.text(row, column) {
            None | Some("") => Ok(None),
            Some(_) => self.number(row, column, fits, expected).map(Some),
        }
    }

    /// The complaint about a cell.
    pub(crate) fn bad(&self, row: usize, column: &str, found: &str, expected: &str) -> Error {
        let line = self.rows[row]
            .position()
            .map_or(row as u64 + 2, |p| p.line());
        Error::BadValue {
            file: self.file.clone(),
            row: line,
            column: column.into(),
            found: if found.is_empty() {
                "nothing".into()
            } else {
                found.into()
            },
            expected: expected.into(),
        }
    }
}
