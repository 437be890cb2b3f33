//! Recordings as text: CSV with commas, semicolons or tabs, below whatever head.

use crate::error::Error;
use crate::source::cell::number;
use crate::source::encoding::text_of;
use crate::source::layout::{TextOptions, layout_of};
use crate::source::log::{Channel, Log};

/// Reads a text file; of the channels only those `wanted` by name, or all that hold numbers.
///
/// A last line that is cut short is left out, with a remark: a logger that loses its power writes such.
///
/// # Errors
/// [`Error::File`] where there are no rows of numbers, [`Error::Cell`] for text in a channel that is wanted and for a row
/// with more or fewer cells than names.
pub fn read_text(
    bytes: &[u8],
    options: TextOptions,
    wanted: Option<&[&str]>,
    file: &str,
) -> Result<Log, Error> {
    let text = text_of(bytes);
    let layout = layout_of(&text, options, file)?;
    let channels = layout
        .names
        .iter()
        .zip(&layout.units)
        .map(|(name, unit)| Channel {
            name: name.clone(),
            unit: unit.clone(),
            clock: None,
            values: Vec::new(),
        });
    let mut log = Log {
        channels: channels.collect(),
        first_row: layout.first_row,
        ..Log::default()
    };
    let mut read = vec![wanted.is_none(); log.channels.len()];
    for name in wanted.unwrap_or_default() {
        read[log.find(name, file)?] = true;
    }
    let mut table = csv::ReaderBuilder::new()
        .delimiter(layout.delimiter)
        .has_headers(false)
        .flexible(true)
        .buffer_capacity(1 << 16)
        .from_reader(&text.as_bytes()[layout.start..]);
    let width = log.channels.len();
    let ends_whole = text.ends_with('\n');
    let mut record = csv::ByteRecord::new();
    let mut short: Option<(u64, usize)> = None;
    let told = |error: csv::Error| Error::file(file, error);
    while table.read_byte_record(&mut record).map_err(told)? {
        let line = record.position().map_or(0, csv::Position::line) + layout.first_row - 1;
        if record.iter().all(|cell| cell.trim_ascii().is_empty()) {
            continue;
        }
        if let Some((row, cells)) = short.take() {
            return Err(wrong_width(file, row, cells, width));
        }
        let extra = record.len() > width;
        if extra
            && !record
                .iter()
                .skip(width)
                .all(|cell| cell.trim_ascii().is_empty())
        {
            return Err(wrong_width(file, line, record.len(), width));
        }
        if record.len() < width {
            short = Some((line, record.len()));
            continue;
        }
        for ((cell, channel), read) in record.iter().zip(&mut log.channels).zip(&mut read) {
            if !*read {
                continue;
            }
            let text = std::str::from_utf8(cell).unwrap_or("");
            match number(text, layout.decimal_comma) {
                Some(value) => channel.values.push(value),
                None if wanted.is_none() => {
                    *read = false;
                    channel.values = Vec::new();
                }
                None => {
                    return Err(Error::Cell {
                        file: file.to_string(),
                        row: line,
                        channel: channel.name.clone(),
                        found: text.to_string(),
                        expected: "a number",
                    });
                }
            }
        }
    }
    if let Some((row, cells)) = short {
        // A whole last line that is short is another file's, or edited.
        if ends_whole {
            return Err(wrong_width(file, row, cells, width));
        }
        log.remarks.push(format!(
            "{file}: row {row}, the last, is cut short and left out"
        ));
    }
    if wanted.is_none() {
        let mut kept = read.iter();
        log.channels.retain(|_| *kept.next().unwrap_or(&false));
    }
    Ok(log)
}

fn wrong_width(file: &str, row: u64, cells: usize, names: usize) -> Error {
    Error::file(
        file,
        format!("row {row}: found {cells} cells, expected {names}, one below each name"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, wanted: Option<&[&str]>) -> Result<Log, Error> {
        read_text(text.as_bytes(), TextOptions::default(), wanted, "a.csv")
    }

    #[test]
    fn wanted_channels_are_read_and_no_others() {
        let text = "Zeit;v [km/h];Ort\n0,0;1,5;hier\n0,1;;da\n";
        let log = read(text, Some(&["v"])).unwrap();
        assert_eq!(log.channels[1].unit.as_deref(), Some("km/h"));
        assert_eq!(log.channels[1].values[0], 1.5);
        assert!(log.channels[1].values[1].is_nan());
        assert!(log.channels[0].values.is_empty());
        let all = read(text, None).unwrap();
        let names: Vec<&str> = all.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["Zeit", "v"]);
    }

    #[test]
    fn what_cannot_be_read_is_named_with_its_place() {
        let told = |text: &str, wanted: &str| read(text, Some(&[wanted])).unwrap_err().to_string();
        assert_eq!(
            told("t,v\n0,1\n1,2\n2,fast\n", "v"),
            "a.csv: row 4, channel \"v\": found \"fast\", expected a number"
        );
        assert_eq!(
            told("t,v\n0,1\n1,2\n2,3,4\n", "v"),
            "a.csv: row 4: found 3 cells, expected 2, one below each name"
        );
        assert_eq!(
            told("t,v\n0,1\n1,2\n", "w"),
            "a.csv: there is no channel \"w\", expected one of: t, v"
        );
    }

    #[test]
    fn a_last_line_without_its_end_is_left_out_and_said() {
        let log = read("t,v,w\n0,1,2\n1,2,3\n2,3", Some(&["v"])).unwrap();
        assert_eq!(log.channels[1].values, [1.0, 2.0]);
        assert_eq!(
            log.remarks,
            ["a.csv: row 4, the last, is cut short and left out"]
        );
        assert!(read("t,v,w\n0,1,2\n1,2,3\n2,3\n", Some(&["v"])).is_err());
        assert!(read("t,v,w\n0,1,2\n1,2\n2,3,4\n", Some(&["v"])).is_err());
    }
}
