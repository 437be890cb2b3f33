//! Where in a text file the names, the units and the numbers stand, and what separates them.

use crate::error::Error;
use crate::source::cell::number;
use crate::unit::{column_unit, is_unit};

/// Lines that are looked at for the first row of numbers.
const LINES: usize = 500;

/// What a text file is like, where it is not to be found out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextOptions {
    /// Between two cells: comma, semicolon, tab.
    pub delimiter: Option<u8>,
    /// Whether decimals stand behind a comma.
    pub decimal_comma: Option<bool>,
}

/// The layout of a text file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub delimiter: u8,
    pub decimal_comma: bool,
    /// Names, without units.
    pub names: Vec<String>,
    /// Units, where the file states them.
    pub units: Vec<Option<String>>,
    /// Place of the first row of numbers [bytes], and its line counted from 1.
    pub start: usize,
    pub first_row: u64,
}

struct Line<'a> {
    at: usize,
    number: u64,
    cells: Vec<&'a str>,
}

/// Finds the first two lines of numbers, and names and units above them.
///
/// The delimiter is a semicolon or a tab where the lines have one, else a comma; decimals stand behind commas where the
/// delimiter is none and a cell holds one. Names are the line above the numbers, or the one above that where the line
/// between holds units; a name may have its unit behind it in brackets.
///
/// # Errors
/// [`Error::File`] where there are no such lines.
pub(crate) fn layout_of(text: &str, options: TextOptions, file: &str) -> Result<Layout, Error> {
    let tried: Vec<u8> = match options.delimiter {
        Some(delimiter) => vec![delimiter],
        None => vec![b';', b'\t', b','],
    };
    for delimiter in tried {
        let commas = delimiter != b',';
        let decimal_comma = options.decimal_comma.unwrap_or(commas);
        if let Some(layout) = with_delimiter(text, delimiter, decimal_comma) {
            return Ok(layout);
        }
    }
    Err(Error::file(
        file,
        format!(
            "found no line of names with lines of numbers below it in the first {LINES} lines; expected columns separated by commas, semicolons or tabs"
        ),
    ))
}

fn with_delimiter(text: &str, delimiter: u8, decimal_comma: bool) -> Option<Layout> {
    let mut lines: Vec<Line> = Vec::new();
    let mut at = 0;
    for (number, line) in text.split_inclusive('\n').take(LINES).enumerate() {
        let bare = line.trim_end_matches(['\n', '\r']);
        if !bare.trim().is_empty() {
            lines.push(Line {
                at,
                number: number as u64 + 1,
                cells: cells(bare, delimiter as char),
            });
        }
        at += line.len();
    }
    let is_data = |line: &Line| {
        let numbers = line
            .cells
            .iter()
            .filter(|cell| number(cell, decimal_comma).is_some_and(f64::is_finite));
        let numbers = numbers.count();
        let empty = line.cells.iter().filter(|cell| cell.is_empty()).count();
        line.cells.len() >= 2 && numbers >= 1 && 2 * (numbers + empty) > line.cells.len()
    };
    // Some write a delimiter behind the last number, and none behind the last name.
    let fits = |row: &Line, names: &Line| {
        let more = row.cells.len() == names.cells.len() + 1;
        row.cells.len() == names.cells.len() || more && row.cells.last() == Some(&"")
    };
    let first = (1..lines.len()).find(|&i| {
        let alike = |j: usize| lines[j].cells.len() == lines[i].cells.len();
        let followed = i + 1 == lines.len() || alike(i + 1) && is_data(&lines[i + 1]);
        is_data(&lines[i]) && followed && fits(&lines[i], &lines[i - 1]) && !is_data(&lines[i - 1])
    })?;
    let width = lines[first - 1].cells.len();
    let above = |i: usize| &lines[first - i].cells;
    // Most of it are units, and less than half of that above it: some units are a maker's own, some names are units too.
    let units_row = first >= 2 && lines[first - 2].cells.len() == width && {
        let (below, names) = (unit_share(above(1)), unit_share(above(2)));
        below > 0.6 && names < 0.5 * below
    };
    let header = above(if units_row { 2 } else { 1 });
    let split: Vec<(String, Option<String>)> =
        header.iter().map(|cell| name_and_unit(cell)).collect();
    let units = (0..width).map(|i| {
        let below = units_row.then(|| above(1)[i].trim_matches(['[', ']', '(', ')', ' ']));
        let below = below.filter(|unit| !unit.is_empty()).map(str::to_string);
        below.or_else(|| split[i].1.clone())
    });
    Some(Layout {
        delimiter,
        decimal_comma,
        units: units.collect(),
        names: split.iter().map(|(name, _)| name.clone()).collect(),
        start: lines[first].at,
        first_row: lines[first].number,
    })
}

/// Cells of a line of the head; numbers are read by the crate csv, which knows quotes that hold line ends too.
fn cells(line: &str, delimiter: char) -> Vec<&str> {
    let mut cells = Vec::new();
    let (mut start, mut quoted) = (0, false);
    for (at, c) in line.char_indices() {
        if c == '"' {
            quoted = !quoted;
        } else if c == delimiter && !quoted {
            cells.push(&line[start..at]);
            start = at + c.len_utf8();
        }
    }
    cells.push(&line[start..]);
    cells
        .into_iter()
        .map(|cell| cell.trim().trim_matches('"').trim())
        .collect()
}

/// `Speed [km/h]` is Speed in km/h; without brackets a name of kufe's own has the unit that it ends in.
fn name_and_unit(cell: &str) -> (String, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, rest)) = cell.rsplit_once(open)
            && let Some(unit) = rest.trim_end().strip_suffix(close)
            && !name.trim().is_empty()
        {
            return (name.trim().to_string(), Some(unit.trim().to_string()));
        }
    }
    let own = column_unit(cell);
    let own = (own != "1").then(|| own.to_string());
    (cell.to_string(), own)
}

/// Share of the cells with something in them that the unit library knows.
fn unit_share(cells: &[&str]) -> f64 {
    let told: Vec<&&str> = cells.iter().filter(|cell| !cell.is_empty()).collect();
    let units = told
        .iter()
        .filter(|cell| ["-", "#"].contains(**cell) || is_unit(cell));
    units.count() as f64 / told.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Layout {
        layout_of(text, TextOptions::default(), "a.csv").unwrap()
    }

    #[test]
    fn names_units_and_numbers_are_found_below_any_head() {
        let plain = found("t_s,v_mps\n0,1\n0.1,2\n");
        assert_eq!((plain.delimiter, plain.first_row), (b',', 2));
        assert_eq!(
            plain.units,
            [Some("s".to_string()), Some("m/s".to_string())]
        );
        let german = found("# Fahrt 3\nZeit [s];Lenkwinkel [°]\n0,00;-1,5\n0,01;-1,6\n");
        assert_eq!((german.delimiter, german.decimal_comma), (b';', true));
        assert_eq!(german.names, ["Zeit", "Lenkwinkel"]);
        assert_eq!(german.units[1].as_deref(), Some("°"));
        let aim = found(
            "\"Format\",\"AiM CSV File\"\n\"Venue\",\"Igls\"\n\n\"Time\",\"GPS Speed\",\"Lateral Acc\"\n\"s\",\"km/h\",\"g\"\n\n0.00,1.0,0.1\n0.05,1.1,0.2\n",
        );
        assert_eq!(aim.names, ["Time", "GPS Speed", "Lateral Acc"]);
        assert_eq!(aim.units[2].as_deref(), Some("g"));
        assert_eq!(aim.first_row, 7);
        let tabs = found("time\tax (m/s^2)\n1\t\n2\t3.5\n");
        assert_eq!(
            (tabs.delimiter, tabs.units[1].as_deref()),
            (b'\t', Some("m/s^2"))
        );
    }

    #[test]
    fn a_last_cell_may_be_empty_or_be_none() {
        assert_eq!(found("t,a,b\n0,1,\n1,2,3\n").names, ["t", "a", "b"]);
        assert_eq!(found("t,a\n0,1,\n1,2,\n").names, ["t", "a"]);
        assert_eq!(found("t,a,\n0,1,\n1,2,\n").names, ["t", "a", ""]);
    }

    #[test]
    fn a_name_that_is_a_unit_too_stays_a_name() {
        // g, s and m are units and names; two lines of them are names and units.
        let both = found("s,g\ns,m\n0,1\n1,2\n");
        assert_eq!(both.names, ["s", "m"]);
        let names = found("s,g\n0,1\n1,2\n");
        assert_eq!(names.names, ["s", "g"]);
    }

    #[test]
    fn text_without_rows_of_numbers_is_refused() {
        for text in [
            "",
            "a,b\n",
            "a,b\nx,y\n",
            "1,2\n3,4\n",
            "only one column\n1\n2\n",
        ] {
            let error = layout_of(text, TextOptions::default(), "a.csv").unwrap_err();
            assert!(
                error
                    .to_string()
                    .starts_with("a.csv: found no line of names"),
                "{text:?}"
            );
        }
    }
}
