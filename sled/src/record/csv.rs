//! Columns of numbers from CSV and to it.

use crate::error::Error;
use crate::record::columns::{Columns, collect};

/// Reads a CSV with one header line; see [`crate::read_columns`].
///
/// # Errors
/// [`Error::File`], [`Error::Cell`], [`Error::Column`].
pub fn read_csv(
    reader: impl std::io::Read,
    required: &[&str],
    file: &str,
) -> Result<Columns, Error> {
    let mut table = csv::ReaderBuilder::new()
        .buffer_capacity(1 << 16)
        .from_reader(reader);
    let names: Vec<String> = table
        .headers()
        .map_err(|error| Error::file(file, error))?
        .iter()
        .map(|name| name.trim().to_string())
        .collect();
    // `None` once a column has turned out to hold text.
    let mut columns: Vec<Option<Vec<f64>>> = vec![Some(Vec::new()); names.len()];
    let mut record = csv::ByteRecord::new();
    while table
        .read_byte_record(&mut record)
        .map_err(|error| Error::file(file, error))?
    {
        for ((cell, slot), name) in record.iter().zip(&mut columns).zip(&names) {
            let Some(values) = slot else { continue };
            match parse_number(cell) {
                Some(value) => values.push(value),
                None if name == "t_s" || required.contains(&name.as_str()) => {
                    return Err(Error::Cell {
                        file: file.to_string(),
                        row: record.position().map_or(0, |position| position.line()),
                        column: name.clone(),
                        found: String::from_utf8_lossy(cell).into_owned(),
                        expected: "a number".to_string(),
                    });
                }
                None => *slot = None,
            }
        }
    }
    collect(
        names
            .into_iter()
            .zip(columns)
            .filter_map(|(name, values)| Some((name, values?))),
        file,
    )
}

fn parse_number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    // How other programs write that there is no value.
    if ["", "NA", "N/A", "null", "None"].contains(&text) {
        return Some(f64::NAN);
    }
    text.parse().ok()
}

/// Writes columns as CSV in the order given, each number in the shortest form that reads back to the same bits.
///
/// # Errors
/// The writer's.
pub fn write_csv(
    mut writer: impl std::io::Write,
    columns: &[(&str, &[f64])],
) -> std::io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    writeln!(writer, "{}", names.join(","))?;
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    for row in 0..rows {
        for (place, (_, values)) in columns.iter().enumerate() {
            let comma = if place == 0 { "" } else { "," };
            write!(writer, "{comma}{}", values[row])?;
        }
        writeln!(writer)?;
    }
    // A buffer that is dropped keeps to itself that it could not be written.
    writer.flush()
}
