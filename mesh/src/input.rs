//! Files as bytes, and tables of numbers.

use std::path::Path;

use kufe_files::{TABLE_TEXT, column_names, line_of_row, read_regular, row_error};

use crate::error::MeshError;

/// The bytes of a file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, MeshError> {
    read_regular(path, limit).map_err(|source| MeshError::Io {
        path: path.display().to_string(),
        source,
    })
}

/// The ending of a file's name in lower case.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default();
    ending.to_string_lossy().to_lowercase()
}

/// Columns of a CSV table by their names, row by row [m]; other columns are ignored.
///
/// # Errors
/// [`MeshError::Value`] with the line of the table and the column.
pub(crate) fn read_columns<const N: usize>(
    text: &[u8],
    names: [&str; N],
) -> Result<Vec<[f64; N]>, MeshError> {
    let mut table = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text);
    let wrong = |row: u64, column: &str, found: String| {
        let place = format!("row {row}, column {column}");
        MeshError::value(place, found, "a number in [m]")
    };
    let headers = table
        .byte_headers()
        .map_err(|error| wrong(1, "header", error.to_string()))?;
    let headers =
        column_names(headers.iter()).map_err(|what| MeshError::value("row 1", what, TABLE_TEXT))?;
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        let missing = || {
            let found = format!("the columns {}", headers.join(","));
            MeshError::value("row 1", found, format!("a column {name}"))
        };
        *column = headers.iter().position(|h| h == name).ok_or_else(missing)?;
        if headers.iter().filter(|h| *h == name).count() > 1 {
            return Err(wrong(1, name, "the column twice".into()));
        }
    }
    let mut rows = Vec::new();
    for record in table.records() {
        let record = record.map_err(|error| MeshError::Invalid(row_error(text, &error)))?;
        let line = line_of_row(text, &record);
        let mut row = [0.0; N];
        for ((value, column), name) in row.iter_mut().zip(columns).zip(names) {
            let text = record.get(column).unwrap_or_default();
            let number = text.parse().ok().filter(|v: &f64| v.is_finite());
            *value = number.ok_or_else(|| wrong(line, name, format!("{text:?}")))?;
        }
        rows.push(row);
    }
    Ok(rows)
}
