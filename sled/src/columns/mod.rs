//! Columns of numbers by name, read from CSV, Parquet and MATLAB files.

pub(crate) mod matlab;
pub(crate) mod parquet;
pub(crate) mod table;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use kufe_files::{TABLE_TEXT, column_names, shown_name};

use crate::columns::matlab::{LONGEST_MATLAB, read_matlab_columns};
use crate::columns::parquet::read_parquet;
use crate::error::Error;

/// Columns by name, all of one length.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// Columns with the place of each row in their file.
#[derive(Clone, Debug, Default)]
pub struct FileColumns {
    /// Columns by name.
    pub columns: Columns,
    /// The line of each row in a text file; in other files its number, from 1.
    pub lines: Vec<u64>,
}

/// Most numbers of a file, 192 MB: 3 hours of 20 channels at 100 Hz.
///
/// The limit is needed because a compressed file may contain ten thousand constants in a byte.
pub const MOST_NUMBERS: u64 = 24_000_000;

/// The error of a file with more than [`MOST_NUMBERS`].
pub(crate) fn too_many(file: &str) -> Error {
    let reason = format!(
        "it holds more than {MOST_NUMBERS} numbers; expected fewer: write fewer columns or rows"
    );
    Error::file(file, reason)
}

/// Collects named columns of one length.
///
/// # Errors
/// [`Error::Column`] for a name given twice, [`Error::File`] for different lengths.
pub(crate) fn collect(
    columns: impl Iterator<Item = (String, Vec<f64>)>,
    file: &str,
) -> Result<Columns, Error> {
    let mut gathered = Columns::new();
    for (name, values) in columns {
        let name = shown_name(&name);
        if gathered.contains_key(&name) {
            return Err(given_twice(&name, file));
        }
        gathered.insert(name, values);
    }
    let mut lengths = gathered.values().map(Vec::len);
    let first = lengths.next();
    if lengths.any(|length| Some(length) != first) {
        let lengths = gathered
            .iter()
            .map(|(name, values)| format!("{name} {}", values.len()));
        let lengths = lengths.collect::<Vec<String>>().join(", ");
        let reason = format!("columns differ in length: {lengths}");
        return Err(Error::file(file, reason));
    }
    Ok(gathered)
}

fn given_twice(column: &str, file: &str) -> Error {
    Error::column(file, column, "given twice", "each column once")
}

/// Reads a CSV with one header line; see [`crate::read_columns`].
///
/// # Errors
/// [`Error::File`], [`Error::Cell`], [`Error::Column`].
pub fn read_csv(
    reader: impl std::io::Read,
    required: &[&str],
    file: &str,
) -> Result<FileColumns, Error> {
    let failure = |error: csv::Error| Error::file(file, error);
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    let head = reader
        .fill_buf()
        .map_err(|error| Error::file(file, error))?;
    let mut ends = head.split_inclusive(|byte| *byte == b'\n');
    let is_crlf = ends.next().is_some_and(|line| line.ends_with(b"\r\n"));
    // The library counts the line feeds up to the end of a row. It passes that of CRLF with the
    // next row.
    let line = |record: &csv::ByteRecord, end: &csv::Position| {
        let begin = record.position().map_or(0, csv::Position::line);
        begin.max(end.line() - u64::from(!is_crlf))
    };
    let mut table = csv::ReaderBuilder::new()
        .buffer_capacity(1 << 16)
        .flexible(true)
        .from_reader(reader);
    let names = column_names(table.byte_headers().map_err(failure)?.iter());
    let names = names.map_err(|what| {
        let advice = "kufe runs import writes that of such files";
        Error::file(file, format!("{what}; expected {TABLE_TEXT}: {advice}"))
    })?;
    let is_repeated = |i: &usize| !names[*i].is_empty() && names[..*i].contains(&names[*i]);
    if let Some(repeated) = (0..names.len()).find(is_repeated) {
        return Err(given_twice(&names[repeated], file));
    }
    // `None` for a column with text.
    let mut columns: Vec<Option<Vec<f64>>> = vec![Some(Vec::new()); names.len()];
    let mut record = csv::ByteRecord::new();
    let mut lines = Vec::new();
    let mut count = 0;
    while table.read_byte_record(&mut record).map_err(failure)? {
        let row = line(&record, table.position());
        if record.len() != names.len() {
            // A blank line is no row.
            if record.iter().all(|cell| cell.trim_ascii().is_empty()) {
                continue;
            }
            let (found, expected) = (record.len(), names.len());
            let reason = format!("found {found} cells, expected {expected}, one below each name");
            return Err(Error::row(file, row, reason));
        }
        lines.push(row);
        for ((cell, slot), name) in record.iter().zip(&mut columns).zip(&names) {
            let Some(values) = slot else { continue };
            match parse_number(cell) {
                Some(value) => {
                    count += 1;
                    values.push(value);
                }
                None if name == "t_s" || required.contains(&name.as_str()) => {
                    let found = String::from_utf8_lossy(cell);
                    return Err(Error::cell(file, row, name, found, "a number"));
                }
                None => *slot = None,
            }
        }
        if count > MOST_NUMBERS {
            return Err(too_many(file));
        }
    }
    let columns = names.into_iter().zip(columns);
    let numeric = columns.filter_map(|(name, values)| Some((name, values?)));
    Ok(FileColumns {
        columns: collect(numeric, file)?,
        lines,
    })
}

fn parse_number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    // Missing values as other programs write them.
    if ["", "NA", "N/A", "null", "None"].contains(&text) {
        return Some(f64::NAN);
    }
    let value: f64 = text.parse().ok()?;
    // `inf` is a number; digits that overflow are not.
    let overflows = value.is_infinite() && text.contains(|c: char| c.is_ascii_digit());
    (!overflows).then_some(value)
}

/// Writes columns as CSV in the given order. Each number has the shortest form with the same bits.
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
    // A buffer reports no error when it is dropped.
    writer.flush()
}

/// Reads every numeric column of a file in the format of its extension (CSV if unknown).
///
/// A column with text is omitted unless it is `required`. Empty cells and nulls become NaN. The last
/// line of a text file is not read if it has no end: see [`is_cut_short`].
///
/// # Errors
/// [`Error::File`], [`Error::Cell`], [`Error::Column`] for a column given twice.
pub fn read_columns(path: &Path, required: &[&str]) -> Result<FileColumns, Error> {
    let file = path.display().to_string();
    let failure = |error: std::io::Error| Error::file(&file, error);
    let open = || kufe_files::open_regular(path).map_err(failure);
    let columns = match ending(path).as_str() {
        "parquet" => collect(read_parquet(open()?, None, &file)?.into_iter(), &file)?,
        "mat" => {
            let bytes = kufe_files::read_regular(path, LONGEST_MATLAB).map_err(failure)?;
            read_matlab_columns(&bytes, &file)?
        }
        "mf4" | "mdf" => {
            let reason =
                "an MDF 4 log; expected CSV, Parquet or MATLAB v5: kufe runs import writes it";
            return Err(Error::file(&file, reason));
        }
        _ => {
            let mut text = open()?;
            let whole = whole_lines(&mut text).map_err(failure)?;
            return read_csv(text.take(whole), required, &file);
        }
    };
    let rows = columns.values().next().map_or(0, Vec::len) as u64;
    Ok(FileColumns {
        columns,
        lines: (1..=rows).collect(),
    })
}

/// The extension of a file in lower case.
fn ending(path: &Path) -> String {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    ending.to_ascii_lowercase()
}

/// Whether a text file ends within a line: a recorder that loses power writes such files, and their
/// last number may be wrong.
pub(crate) fn is_cut_short(path: &Path) -> bool {
    if ["parquet", "mat"].contains(&ending(path).as_str()) {
        return false;
    }
    let lengths = kufe_files::open_regular(path)
        .and_then(|mut text| Ok((whole_lines(&mut text)?, text.metadata()?.len())));
    lengths.is_ok_and(|(whole, length)| whole < length)
}

/// Length of a text up to the end of its last whole line, or of the whole text if no line ends
/// [bytes].
fn whole_lines(text: &mut File) -> std::io::Result<u64> {
    const BLOCK: u64 = 1 << 16;
    let length = text.metadata()?.len();
    let mut end = length;
    let mut whole = length;
    while end > 0 {
        let start = end.saturating_sub(BLOCK);
        let mut block = vec![0; (end - start) as usize];
        text.seek(SeekFrom::Start(start))?;
        text.read_exact(&mut block)?;
        if let Some(last) = block.iter().rposition(|byte| *byte == b'\n') {
            whole = start + last as u64 + 1;
            break;
        }
        end = start;
    }
    text.seek(SeekFrom::Start(0))?;
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_the_line_of_the_file() {
        for end in ["\n", "\r\n"] {
            for (lines, row) in [
                (&["t_s,v_mps", "0,1", "x,2", "3,4"][..], "row 3"),
                (&["t_s,v_mps", "0,1", "", "x,2", ""], "row 4"),
                (&["t_s,v_mps", "0,1", "1,2,3", ""], "row 3"),
                (&["t_s,v_mps", "0,1", "x,2"], "row 3"),
            ] {
                let text = lines.join(end);
                let error = read_csv(text.as_bytes(), &[], "a.csv").unwrap_err();
                assert!(error.to_string().contains(row), "{text:?}: {error}");
            }
        }
    }
}
