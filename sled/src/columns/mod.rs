//! Columns of numbers by name, read from CSV, Parquet, MATLAB and MDF 4 files.

pub(crate) mod matlab;
mod mdf4;
pub(crate) mod parquet;

use std::collections::BTreeMap;
use std::path::Path;

use crate::columns::matlab::read_matlab_columns;
use crate::columns::mdf4::read_mdf4;
use crate::columns::parquet::read_parquet;
use crate::error::Error;

/// Columns by name, all of one length.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// Most numbers that a packed file of so many bytes may unpack to: 320 MB of them, or one for each byte.
///
/// A file of constants packs ten thousand numbers into a byte; a recording of sensors takes more than a byte for each.
pub fn most_values(bytes: u64) -> u64 {
    bytes.max(40_000_000)
}

/// Gathers named columns and refuses a name given twice.
pub(crate) fn collect(
    columns: impl Iterator<Item = (String, Vec<f64>)>,
    file: &str,
) -> Result<Columns, Error> {
    let mut gathered = Columns::new();
    for (name, values) in columns {
        if gathered.contains_key(&name) {
            return Err(Error::Column {
                file: file.to_string(),
                column: name,
                what: "given twice",
                expected: "each column once".to_string(),
            });
        }
        gathered.insert(name, values);
    }
    let lengths: Vec<usize> = gathered.values().map(Vec::len).collect();
    if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
        let told: Vec<String> = gathered
            .iter()
            .map(|(name, values)| format!("{name} {}", values.len()))
            .collect();
        return Err(Error::file(
            file,
            format!("columns differ in length: {}", told.join(", ")),
        ));
    }
    Ok(gathered)
}

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
