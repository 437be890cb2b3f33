//! Small CSV tables of names and numbers: indices, experiments, glides.

use std::fmt::Display;
use std::io::Read;

use kufe_files::{TABLE_TEXT, column_names, line_of_row, row_error};

use crate::conditions::{CONDITIONS, Conditions};
use crate::error::Error;

/// Quantities of measured tables: name, smallest and largest value, and the expectation in words.
const NUMBERS: [(&str, f64, f64, &str); 14] = [
    ("p_max_pa", 1e4, 1e11, "a pressure in Pa (7.7e6)"),
    ("p_max_sd_pa", 0.0, 1e11, "a deviation in Pa, 0 to 1e11"),
    ("mu", LEAST, 1.0, "a coefficient of friction above 0"),
    ("mu_sd", 0.0, 1.0, "a standard deviation (0.0004), 0 to 1"),
    ("fz_n", LEAST, f64::MAX, "a force in N, positive"),
    ("v_mps", 0.0, f64::MAX, "a speed in m/s, 0 or more"),
    ("ice_c", -60.0, 60.0, CELSIUS),
    ("air_c", -60.0, 60.0, CELSIUS),
    ("humidity_pct", 0.0, 100.0, "a humidity in %, 0 to 100"),
    ("air_pa", 30e3, 120e3, "a pressure, 30000 to 120000 Pa"),
    ("distance_m", 0.0, f64::MAX, "a distance in m, 0 or more"),
    ("rocker_radius_m", LEAST, f64::MAX, "a radius, above 0 m"),
    ("mass_kg", 1.0, 2000.0, "a mass in kg, 1 to 2000"),
    ("cda_m2", 0.0, 5.0, "a drag area in m2, 0 to 5"),
];

const CELSIUS: &str = "a temperature in degrees Celsius, -60 to 60";

/// Largest size of a table [bytes]: empty cells and short rows need up to twenty times as much memory.
const MAX_BYTES: u64 = 1 << 25;

/// The least positive number.
const LEAST: f64 = f64::MIN_POSITIVE;

/// The columns of a table.
pub(crate) struct TableColumns {
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
    /// Whether a further column of this name is allowed.
    pub further: fn(&str) -> bool,
    /// Further names, for errors.
    pub further_names: &'static str,
}

/// A table of text cells.
pub(crate) struct Table {
    file: String,
    columns: &'static TableColumns,
    pub(crate) header: Vec<String>,
    rows: Vec<csv::StringRecord>,
    /// Lines of the rows in the file.
    lines: Vec<u64>,
}

impl Table {
    pub(crate) fn read(
        file: &str,
        reader: impl Read,
        columns: &'static TableColumns,
    ) -> Result<Self, Error> {
        let unreadable =
            |reason: &dyn Display| Error::file(file, format!("cannot be read: {reason}"));
        let mut text = Vec::new();
        let read = reader.take(MAX_BYTES + 1).read_to_end(&mut text);
        if read.map_err(|error| unreadable(&error))? as u64 > MAX_BYTES {
            let reason = format!("it is longer than {MAX_BYTES} bytes: expected fewer rows");
            return Err(unreadable(&reason));
        }
        let mut csv = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text.as_slice());
        let cells = csv.byte_headers().map_err(|error| unreadable(&error))?;
        let header = column_names(cells.iter())
            .map_err(|what| Error::file(file, format!("{what}; expected {TABLE_TEXT}")))?;
        let all = [columns.required, columns.optional].concat();
        for (i, name) in header.iter().enumerate() {
            let expected = || all.join(", ") + columns.further_names;
            if header[..i].contains(name) {
                return Err(Error::column(file, name, "given twice", &expected()));
            }
            if !all.contains(&name.as_str()) && !(columns.further)(name) {
                return Err(Error::column(file, name, "unknown", &expected()));
            }
        }
        let absent = |name: &&&str| !header.iter().any(|there| there == **name);
        if let Some(name) = columns.required.iter().find(absent) {
            return Err(Error::missing_column(file, name, &header));
        }
        let rows: Result<Vec<_>, _> = csv.records().collect();
        let rows = rows.map_err(|error| Error::file(file, row_error(&text, &error)))?;
        let lines = rows.iter().map(|row| line_of_row(&text, row));
        Ok(Table {
            file: file.into(),
            columns,
            header,
            lines: lines.collect(),
            rows,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Line of a row in the file.
    pub(crate) fn line(&self, row: usize) -> u64 {
        self.lines[row]
    }

    /// The text of a cell; `None` if there is no such column.
    pub(crate) fn text(&self, row: usize, column: &str) -> Option<&str> {
        let place = self.header.iter().position(|name| name == column)?;
        self.rows[row].get(place)
    }

    /// The text of a cell; `None` if it is empty or absent.
    pub(crate) fn nonempty_text(&self, row: usize, column: &str) -> Option<String> {
        let text = self.text(row, column).filter(|text| !text.is_empty());
        text.map(str::to_string)
    }

    /// The text of a cell, which must not be empty.
    pub(crate) fn name(&self, row: usize, column: &str) -> Result<String, Error> {
        let text = self.nonempty_text(row, column);
        text.ok_or_else(|| self.bad(row, column, "", "a name"))
    }

    /// The cell as a number within the range of its column.
    pub(crate) fn number(&self, row: usize, column: &str) -> Result<f64, Error> {
        let known = NUMBERS.iter().find(|known| known.0 == column);
        let (_, low, high, expected) = known.expect("a column of numbers");
        self.number_within(row, column, (*low, *high), expected)
    }

    /// The cell as a finite number within a range.
    pub(crate) fn number_within(
        &self,
        row: usize,
        column: &str,
        (low, high): (f64, f64),
        expected: &str,
    ) -> Result<f64, Error> {
        let text = self.text(row, column).unwrap_or("");
        let value = text.parse().ok();
        let value = value.filter(|value| (low..=high).contains(value));
        value.ok_or_else(|| self.bad(row, column, text, expected))
    }

    /// As [`Table::number`]; `None` if the cell is empty or absent.
    pub(crate) fn optional(&self, row: usize, column: &str) -> Result<Option<f64>, Error> {
        let cell = self.nonempty_text(row, column);
        cell.map(|_| self.number(row, column)).transpose()
    }

    /// The conditions in a row; NaN for those that the table does not contain.
    pub(crate) fn conditions(&self, row: usize) -> Result<Conditions, Error> {
        let mut values = Conditions::UNSTATED.values();
        for (value, (name, ..)) in values.iter_mut().zip(CONDITIONS) {
            if self.columns.required.contains(&name) {
                *value = self.number(row, name)?;
            } else if self.columns.optional.contains(&name) {
                *value = self.optional(row, name)?.unwrap_or(f64::NAN);
            }
        }
        Ok(Conditions::from_values(values))
    }

    /// The error of a cell.
    pub(crate) fn bad(&self, row: usize, column: &str, found: &str, expected: &str) -> Error {
        Error::cell(&self.file, self.line(row), column, found, expected)
    }
}
