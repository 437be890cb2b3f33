//! Names of the columns of tables, and lines of their rows.

/// What the text of a table must be.
pub const TABLE_TEXT: &str = "UTF-8 with commas between cells";

/// The names of a CSV table's columns from the cells of its first line: each as [`shown_name`]
/// shows it, the first without a byte order mark.
///
/// # Errors
/// What the text is where it is not [`TABLE_TEXT`].
pub fn column_names<'a>(
    cells: impl Iterator<Item = &'a [u8]>,
) -> Result<Vec<String>, &'static str> {
    let cells: Vec<&[u8]> = cells.collect();
    let marks: [&[u8]; 2] = [&[0xff, 0xfe], &[0xfe, 0xff]];
    let is_marked = |first: &&[u8]| marks.iter().any(|mark| first.starts_with(mark));
    if cells.first().is_some_and(is_marked) || cells.iter().any(|cell| cell.contains(&0)) {
        return Err("text in UTF-16");
    }
    let names: Result<Vec<&str>, _> = cells.into_iter().map(std::str::from_utf8).collect();
    let names = names.map_err(|_| "no text in UTF-8")?;
    if let [one] = names[..]
        && one.contains(';')
    {
        return Err("cells separated by semicolons");
    }
    let name = |name: &str| shown_name(name.trim_start_matches('\u{feff}'));
    Ok(names.into_iter().map(name).collect())
}

/// Line of a row of a CSV table, as read from `text`; 0 if the row has no position. The position
/// that the csv reader states precedes the blank lines before the row.
pub fn line_of_row(text: &[u8], row: &csv::StringRecord) -> u64 {
    row.position().map_or(0, |begun| line_of(text, begun))
}

/// The message of an error of the csv reader: of a row with another number of cells than the header
/// its line and both numbers.
pub fn row_error(text: &[u8], error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths {
            pos: Some(begun),
            expected_len,
            len,
        } => format!(
            "row {}: found {len} cells, expected {expected_len}, one below each name",
            line_of(text, begun)
        ),
        _ => error.to_string(),
    }
}

fn line_of(text: &[u8], begun: &csv::Position) -> u64 {
    let ahead = text.get(begun.byte() as usize..).unwrap_or_default();
    let blank = ahead.iter().take_while(|byte| b"\r\n".contains(byte));
    begun.line() + blank.filter(|byte| **byte == b'\n').count() as u64
}

/// A name of a user's file on one line: without blanks at its ends, its line breaks and other
/// characters that steer a terminal or the direction of text as escapes.
///
/// ```
/// assert_eq!(kufe_files::shown_name(" x_tyre\nset "), r"x_tyre\nset");
/// ```
pub fn shown_name(name: &str) -> String {
    let steers = |c: char| {
        let lines = '\u{2028}'..='\u{202e}';
        c.is_control() || lines.contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c)
    };
    let mut shown = String::new();
    for c in name.trim().chars() {
        if steers(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_another_length_is_placed() {
        for end in ["\n", "\r\n"] {
            let text = ["run,file", "a,b", "", "c", ""].join(end);
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            let error = reader.records().find_map(Result::err).unwrap();
            assert_eq!(
                row_error(text.as_bytes(), &error),
                "row 4: found 1 cells, expected 2, one below each name"
            );
        }
    }

    #[test]
    fn names_are_shown_on_one_line_and_other_texts_are_named() {
        let names = |text: &[u8]| column_names(text.split(|byte| *byte == b','));
        let text = "\u{feff}run, fahrt ä,x_a\r\nb\u{1b}[2J,\u{202e}c";
        let expected = ["run", "fahrt ä", r"x_a\r\nb\u{1b}[2J", r"\u{202e}c"];
        assert_eq!(names(text.as_bytes()).unwrap(), expected);
        let wide = |unit: fn(u16) -> [u8; 2], mark: &[u8]| {
            let units = "run,file".encode_utf16().flat_map(unit);
            [mark, &units.collect::<Vec<u8>>()].concat()
        };
        for text in [
            wide(u16::to_le_bytes, &[0xff, 0xfe]),
            wide(u16::to_be_bytes, &[0xfe, 0xff]),
            wide(u16::to_le_bytes, &[]),
        ] {
            assert_eq!(names(&text).unwrap_err(), "text in UTF-16");
        }
        assert_eq!(names(b"run,f\xe4hrt").unwrap_err(), "no text in UTF-8");
        let separated = names(b"run;file").unwrap_err();
        assert_eq!(separated, "cells separated by semicolons");
    }
}
