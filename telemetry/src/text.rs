//! Reads recordings in text files: columns below an optional preamble, as AiM, MoTeC, RaceChrono,
//! Race Logic and spreadsheets write them.

use std::io::Read;
use std::iter;

use chrono::NaiveDate;
use kufe_files::shown_name;

use crate::error::Error;
use crate::log::{Channel, Log};
use crate::unit::{is_unit, name_unit};

/// Number of rows in which the names, the units and the delimiter are searched for.
const WINDOW: usize = 500;

/// Maximum length of the text in which they are searched for [bytes].
const MAX_WINDOW_BYTES: usize = 1 << 22;

/// Maximum number of columns. Usual files have about a hundred, rarely a thousand.
const MAX_COLUMNS: usize = 1 << 16;

/// Maximum length of a quoted cell [bytes].
const MAX_CELL_BYTES: usize = 4096;

/// Maximum length of a row [bytes].
const MAX_ROW_BYTES: usize = 1 << 23;

/// Size of the blocks that are read [bytes].
const BLOCK: usize = 1 << 20;

/// Words, in lower case, that programs write for a missing value.
const MISSING: &str = "nan -nan +nan - -- --- n/a na n.a. none null #n/a #nv #div/0! #value! \
    1.#qnan -1.#qnan 1.#ind -1.#ind nan(ind) -nan(ind)";

/// Length of a day [s].
const DAY: f64 = 86_400.0;

/// Properties of a text file; those that are `None` are detected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextOptions {
    /// The byte between two cells: comma, semicolon, tab or space.
    pub delimiter: Option<u8>,
    /// Whether the decimal separator is a comma.
    pub decimal_comma: Option<bool>,
}

/// Converts two bytes to a code unit of UTF-16, in one of the byte orders.
type CodeUnit = fn([u8; 2]) -> u16;

/// Decodes a file block by block. The encoding is UTF-8 or UTF-16, with or without a byte order
/// mark. Bytes that are not valid UTF-8 are decoded as ISO 8859-1, in which every byte is valid.
struct Text<R> {
    reader: R,
    /// Conversion of UTF-16; none for UTF-8.
    wide: Option<CodeUnit>,
    /// Bytes not decoded yet, of a character of which not all bytes are read.
    rest: Vec<u8>,
    /// Text that is decoded and not used yet.
    text: String,
    ended: bool,
}

impl<R: Read> Text<R> {
    fn new(mut reader: R) -> std::io::Result<Text<R>> {
        let mut rest = Vec::new();
        reader.by_ref().take(4).read_to_end(&mut rest)?;
        let (wide, mark) = encoding(&rest);
        rest.drain(..mark);
        Ok(Text {
            reader,
            wide,
            rest,
            text: String::new(),
            ended: false,
        })
    }

    /// Reads and decodes a block, or as many bytes as the text that is not used yet, so that a long
    /// row needs few reads.
    fn read_more(&mut self) -> std::io::Result<()> {
        let wanted = self.text.len().clamp(BLOCK, MAX_WINDOW_BYTES);
        let mut block = self.reader.by_ref().take(wanted as u64);
        let count = block.read_to_end(&mut self.rest)?;
        self.ended = count < wanted;
        let decoded = match self.wide {
            Some(unit) => decode_wide(&self.rest, unit, self.ended, &mut self.text),
            None => decode_narrow(&self.rest, self.ended, &mut self.text),
        };
        self.rest.drain(..decoded);
        Ok(())
    }

    /// Length of the text up to its last line end, or of all of it if it has no line end [bytes].
    fn whole_lines(&self) -> usize {
        self.text.rfind('\n').map_or(self.text.len(), |end| end + 1)
    }
}

/// The conversion of UTF-16, if the text is UTF-16, and the length of the byte order mark.
fn encoding(start: &[u8]) -> (Option<CodeUnit>, usize) {
    match start {
        [0xff, 0xfe, ..] => (Some(u16::from_le_bytes), 2),
        [0xfe, 0xff, ..] => (Some(u16::from_be_bytes), 2),
        // In Latin letters in UTF-16 every other byte is 0.
        [1..=255, 0, 1..=255, 0, ..] => (Some(u16::from_le_bytes), 0),
        [0, 1..=255, 0, 1..=255, ..] => (Some(u16::from_be_bytes), 0),
        [0xef, 0xbb, 0xbf, ..] => (None, 3),
        _ => (None, 0),
    }
}

/// Decodes UTF-8 and appends it to `text`. Returns how many bytes were decoded. Unless `ended`,
/// further bytes may follow.
fn decode_narrow(bytes: &[u8], ended: bool, text: &mut String) -> usize {
    let mut decoded = 0;
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        decoded += chunk.valid().len();
        // The remaining bytes of a character may follow.
        if !ended && decoded + chunk.invalid().len() == bytes.len() {
            break;
        }
        text.extend(chunk.invalid().iter().map(|byte| char::from(*byte)));
        decoded += chunk.invalid().len();
    }
    decoded
}

/// As [`decode_narrow`], for UTF-16.
fn decode_wide(bytes: &[u8], unit: CodeUnit, ended: bool, text: &mut String) -> usize {
    let mut pairs = bytes.as_chunks().0;
    // The other half of a surrogate pair may follow.
    if let [before @ .., last] = pairs
        && !ended
        && (0xd800..0xdc00).contains(&unit(*last))
    {
        pairs = before;
    }
    let units = pairs.iter().map(|pair| unit(*pair));
    text.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    2 * pairs.len()
}

/// The number in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Number {
    /// The value; NaN for a missing value.
    value: f64,
    /// Whether the value is a time of day, or a date and a time [s].
    is_clock: bool,
}

impl Number {
    /// The number in a cell; none if it contains other text.
    fn of(cell: &str, decimal_comma: bool) -> Option<Number> {
        let plain = |value| {
            let is_clock = false;
            Some(Number { value, is_clock })
        };
        let cell = cell.trim();
        if let Ok(value) = cell.parse::<f64>() {
            // The word `inf` marks a missing value; digits that overflow are not a number.
            if value.is_infinite() && cell.contains(|c: char| c.is_ascii_digit()) {
                return None;
            }
            return plain(if value.is_finite() { value } else { f64::NAN });
        }
        let small = cell.to_lowercase();
        let missing = MISSING.split(' ').any(|word| word == small);
        if missing || cell.is_empty() || cell.ends_with("1.#INF") {
            return plain(f64::NAN);
        }
        let comma = cell.rfind(',').filter(|place| place + 1 < cell.len());
        let number = match (comma, cell.rfind('.')) {
            // The later of the two is the decimal separator, the other one separates thousands.
            (Some(comma), Some(point)) if comma < point => cell.replace(',', ""),
            (Some(_), Some(_)) if decimal_comma => cell.replace('.', "").replacen(',', ".", 1),
            (Some(_), None) if decimal_comma => cell.replacen(',', ".", 1),
            _ => String::new(),
        };
        if let Ok(value) = number.parse::<f64>()
            && value.is_finite()
        {
            return plain(value);
        }
        let time = cell.replacen(',', ".", usize::from(decimal_comma));
        let is_clock = true;
        clock(&time).map(|value| Number { value, is_clock })
    }
}

/// Converts `h:m:s` or `m:s` to seconds. A date may precede it; `AM`, `PM` or a time zone may
/// follow.
///
/// Dates are read if the year is first or in the form `d.m.y`. The forms `d/m/y` and `m/d/y` cannot
/// be distinguished; such dates are ignored.
fn clock(cell: &str) -> Option<f64> {
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) if !date.contains(':') => (Some(date), time),
        _ => (None, cell),
    };
    let mut time = time.trim().trim_end_matches(['Z', 'z']);
    let mut afternoon = None;
    for (mark, hours) in [("am", 0.0), ("pm", 12.0)] {
        let before = time.len().saturating_sub(2);
        if time.is_char_boundary(before) && time[before..].eq_ignore_ascii_case(mark) {
            time = time[..before].trim_end();
            afternoon = Some(hours);
        }
    }
    if date.is_some()
        && let Some((before, _)) = time.split_once(['+', '-'])
    {
        time = before;
    }
    let parts: Vec<&str> = time.split(':').collect();
    if !(2..=3).contains(&parts.len()) {
        return None;
    }
    let mut seconds = 0.0;
    for (place, part) in parts.iter().enumerate() {
        let last = place + 1 == parts.len();
        let digits = |b: u8| b.is_ascii_digit() || last && b == b'.';
        if !part.bytes().all(digits) {
            return None;
        }
        let value: f64 = part.parse().ok()?;
        let value = match (place, afternoon) {
            (0, Some(hours)) => value % 12.0 + hours,
            _ => value,
        };
        seconds = seconds * 60.0 + value;
    }
    // With a date, AM or PM, two numbers are hours and minutes.
    if (date.is_some() || afternoon.is_some()) && parts.len() == 2 {
        seconds *= 60.0;
    }
    Some(seconds + date.map_or(Some(0.0), days)? * DAY)
}

/// Number of days from 1970-01-01 to a date; 0 for a date of which the form is ambiguous.
fn days(date: &str) -> Option<f64> {
    let parts: Vec<&str> = date.split(['-', '.', '/']).collect();
    let [first, second, third] = parts[..] else {
        return None;
    };
    let (year, month, day) = if first.len() == 4 {
        (first.parse(), second.parse(), third.parse())
    } else if date.contains('.') {
        (third.parse(), second.parse(), first.parse())
    } else {
        let numbers = parts.iter().all(|part| part.parse::<i64>().is_ok());
        return numbers.then_some(0.0);
    };
    let date = NaiveDate::from_ymd_opt(year.ok()?, month.ok()?, day.ok()?)?;
    Some(f64::from(date.to_epoch_days()))
}

/// Iterator over the rows of a text, split into cells.
struct Rows<'a> {
    text: &'a str,
    at: usize,
    line: u64,
    /// A space means any number of spaces and tabs.
    delimiter: u8,
}

/// A row: its offset [bytes], its line number from 1, and its cells without quotes and blanks.
#[derive(Clone)]
struct Row<'a> {
    at: usize,
    line: u64,
    cells: Vec<&'a str>,
}

impl<'a> Iterator for Rows<'a> {
    type Item = Row<'a>;

    /// The next row that is not empty.
    fn next(&mut self) -> Option<Row<'a>> {
        let bytes = self.text.as_bytes();
        while self.at < bytes.len() {
            let (at, line) = (self.at, self.line);
            let mut cells = Vec::new();
            loop {
                let (from, blanks) = (self.at, self.delimiter == b' ');
                let blank = |b: &&u8| **b == b' ' || **b == b'\t' && blanks;
                let start = from + bytes[from..].iter().take_while(blank).count();
                let quoted = bytes.get(start) == Some(&b'"');
                let closed = quoted.then(|| self.closing_quote(start + 1)).flatten();
                let ends = |b: &u8| {
                    [self.delimiter, b'\n'].contains(b) || blanks && [b'\t', b'\r'].contains(b)
                };
                let search = closed.unwrap_or(start);
                let length = bytes[search..].iter().position(ends);
                self.at = length.map_or(bytes.len(), |length| search + length);
                let cell = match closed {
                    Some(end) => &self.text[start + 1..end - 1],
                    None => &self.text[from..self.at],
                };
                self.line += cell.bytes().filter(|b| *b == b'\n').count() as u64;
                if blanks && bytes[self.at..].starts_with(b"\r\n") {
                    self.at += 1;
                }
                let ended = bytes.get(self.at).is_none_or(|b| *b == b'\n');
                let cell = cell.trim();
                if !(blanks && ended && cell.is_empty()) {
                    cells.push(cell);
                }
                self.at += 1;
                if ended {
                    break;
                }
            }
            self.line += 1;
            if cells.iter().any(|cell| !cell.is_empty()) {
                return Some(Row { at, line, cells });
            }
        }
        None
    }
}

impl Rows<'_> {
    /// The offset after the closing quote of a cell, if a delimiter or the end of the row follows.
    fn closing_quote(&self, from: usize) -> Option<usize> {
        let bytes = self.text.as_bytes();
        let mut at = from;
        while at < bytes.len().min(from + MAX_CELL_BYTES) {
            if bytes[at] == b'"' {
                if bytes.get(at + 1) != Some(&b'"') {
                    let next = bytes[at + 1..].iter().find(|b| **b != b' ');
                    let ends = next.is_none_or(|b| [self.delimiter, b'\n', b'\r'].contains(b));
                    return (ends || self.delimiter == b' ').then_some(at + 1);
                }
                at += 1;
            }
            at += 1;
        }
        None
    }
}

/// The layout of a text file.
struct Layout {
    delimiter: u8,
    decimal_comma: bool,
    /// Names and units of the columns.
    channels: Vec<Channel>,
    /// Sources of the columns, which distinguish columns of equal name.
    sources: Vec<String>,
    /// The rows of names and units, which some programs repeat.
    head: Vec<Vec<String>>,
    /// Offset of the first row of numbers [bytes].
    start: usize,
    /// Line number of the first row of numbers, from 1.
    first_row: u64,
    /// Number of rows of numbers in the searched text.
    score: usize,
    /// Whether the file is of Race Logic: times are `hhmmss.ss`, latitude and longitude are in
    /// minutes, longitude positive to the west.
    vbox: bool,
}

/// Counts the numbers and the words among the cells of a row.
fn contents(cells: &[&str]) -> (usize, usize) {
    let (mut numbers, mut words) = (0, 0);
    for cell in cells {
        match Number::of(cell, true) {
            None => words += 1,
            Some(number) => numbers += usize::from(number.value.is_finite()),
        }
    }
    (numbers, words)
}

/// Finds the names, the units and the first row of numbers, with the delimiter that gives the most
/// rows of numbers.
///
/// The names are the row of words above the numbers. If a row of units is above the numbers, the
/// names are the row above it. A name may be followed by its unit in brackets, or end in it.
///
/// # Errors
/// [`Error::File`] if there are no such rows.
fn layout_of(text: &str, options: TextOptions, file: &str) -> Result<Layout, Error> {
    if let Some(layout) = sections(text) {
        return Ok(layout);
    }
    let delimiters = match options.delimiter {
        Some(delimiter) => vec![delimiter],
        None => vec![b';', b'\t', b',', b' '],
    };
    // If the number of rows is equal, the first delimiter is chosen: `max_by_key` returns the last.
    let layouts = delimiters.into_iter().rev();
    let layouts = layouts.filter_map(|delimiter| with_delimiter(text, delimiter));
    let best = layouts.max_by_key(|layout| layout.score);
    let mut layout = best.ok_or_else(|| {
        let reason = format!(
            "found no row of names with rows of numbers below it in the first {WINDOW} rows; expected columns separated by commas, semicolons, tabs or blanks"
        );
        Error::file(file, reason)
    })?;
    layout.decimal_comma = options.decimal_comma.unwrap_or(layout.decimal_comma);
    Ok(layout)
}

/// The layout with a given delimiter, if there is one.
fn with_delimiter(text: &str, delimiter: u8) -> Option<Layout> {
    let rows = Rows {
        text,
        at: 0,
        line: 1,
        delimiter,
    };
    let rows: Vec<Row> = rows.take(WINDOW).collect();
    // Numbers and words of each row.
    let counts: Vec<(usize, usize)> = rows.iter().map(|row| contents(&row.cells)).collect();
    let width = |i: usize| rows[i].cells.len();
    let is_data = |i: usize| (2..=MAX_COLUMNS).contains(&width(i)) && counts[i].0 > counts[i].1;
    let is_head = |i: usize| counts[i].1 > counts[i].0 && width(i) >= 2;
    // Some programs write a delimiter after the last number but not after the last name, or the
    // other way round.
    let fits = |data: usize, head: usize| {
        let last = |i: usize| rows[i].cells.last() == Some(&"");
        width(data) == width(head)
            || width(data) == width(head) + 1 && last(data)
            || width(data) + 1 == width(head) && last(head)
    };
    let is_names = |i: usize| counts[i].0 == 0 && counts[i].1 >= 2 && 2 * counts[i].1 >= width(i);
    // Number of rows of numbers up to the next row of names.
    let score = |i: usize| {
        let below = (i..rows.len()).take_while(|j| !is_names(*j));
        below
            .filter(|j| is_data(*j) && width(*j) == width(i))
            .count()
    };
    let starts = (1..rows.len()).filter(|&i| {
        // At least half of the numbers must have a name above them; a row of sources may have
        // fewer words.
        let named = |data: usize, head: usize| {
            let filled = |i: usize, k: usize| rows[i].cells.get(k).is_some_and(|c| !c.is_empty());
            let numbers = || (0..width(data)).filter(|k| filled(data, *k));
            2 * numbers().filter(|k| filled(head, *k)).count() >= numbers().count()
        };
        let below_units = i >= 3 && is_head(i - 3) && is_units(&rows[i - 2].cells);
        is_data(i) && fits(i, i - 1) && (is_head(i - 1) && named(i, i - 1) || below_units)
    });
    let first = starts.rev().max_by_key(|&i| score(i))?;
    // The rows of words above the numbers, from the lowest.
    let above = (0..first).rev().take(4);
    let head = above.take_while(|&i| fits(first, i) && counts[i].1 > counts[i].0);
    let head: Vec<usize> = head.collect();
    let share = |i: usize| unit_share(&rows[i].cells);
    let units_at = head.windows(2).position(|pair| {
        let (below, names) = (share(pair[0]), share(pair[1]));
        below > 0.6 && names < 0.7 * below
    });
    let names_at = units_at.map_or(0, |place| place + 1);
    let names_row = &rows[*head.get(names_at)?].cells;
    // Empty names at the end are omitted.
    let width = width(first).min(names_row.len());
    let cell = |place: usize, i: usize| rows[head[place]].cells.get(i).copied().unwrap_or("");
    let marks: &[char] = &['#', '%', '/', ' '];
    let bare = |(i, name)| match i {
        0 => str::trim_start_matches(name, marks),
        _ => name,
    };
    let named = names_row[..width].iter().copied().enumerate().map(bare);
    let mut channels: Vec<Channel> = named.map(channel).collect();
    for (i, channel) in channels.iter_mut().enumerate() {
        let below = units_at.map(|place| cell(place, i).trim_matches(['[', ']', '(', ')', ' ']));
        let below = below.filter(|unit| !unit.is_empty()).map(str::to_string);
        channel.unit = below.or(channel.unit.take());
    }
    let source = |i: usize| match units_at {
        Some(place) if place > 0 => cell(0, i).to_string(),
        _ => String::new(),
    };
    let row = |i: &usize| rows[*i].cells.iter().map(ToString::to_string).collect();
    let (mut comma, mut point) = (false, false);
    for cell in rows[first..].iter().flat_map(|row| &row.cells) {
        point |= cell.contains('.') && cell.parse::<f64>().is_ok();
        comma |= cell.contains(',') && cell.replacen(',', ".", 1).parse::<f64>().is_ok();
    }
    Some(Layout {
        delimiter,
        decimal_comma: comma && (!point || delimiter != b','),
        channels,
        sources: (0..width).map(source).collect(),
        head: head[..=names_at].iter().map(row).collect(),
        start: rows[first].at,
        first_row: rows[first].line,
        score: score(first),
        vbox: false,
    })
}

/// Units of the columns that every file of Race Logic contains.
const VBOX_UNITS: [(&[&str], &str); 3] = [
    (&["time"], "s"),
    (&["lat", "latitude", "long", "longitude", "heading"], "deg"),
    (&["height"], "m"),
];

/// The layout of a file of Race Logic (`.vbo`), with the sections `[header]`, `[column names]` and
/// `[data]`; none for other files.
fn sections(text: &str) -> Option<Layout> {
    let head: Vec<&str> = text.split_inclusive('\n').take(10_000).collect();
    let title = |line: &str| {
        let title = line.trim().strip_prefix('[')?.strip_suffix(']')?;
        Some(title.to_lowercase())
    };
    let begin = |name: &str| {
        let own = |line: &&str| title(line).as_deref() == Some(name);
        head.iter().position(own).map(|line| line + 1)
    };
    let lines = |name: &str| -> Vec<&str> {
        let from = begin(name).unwrap_or(head.len());
        let own = head[from..].iter().take_while(|line| title(line).is_none());
        let bare = own.map(|line| line.trim());
        bare.filter(|line| !line.is_empty()).collect()
    };
    let rows = begin("data")?;
    let names = lines("column names").join(" ");
    let names: Vec<&str> = names.split_whitespace().collect();
    let (width, titles, units) = (names.len(), lines("header"), lines("channel units"));
    if !(2..=MAX_COLUMNS).contains(&width) {
        return None;
    }
    let unit_of = |i: usize, name: &str| -> Option<String> {
        let mut known = VBOX_UNITS.iter();
        let known = known.find(|(names, _)| names.contains(&&*name.to_lowercase()));
        if let Some((_, unit)) = known {
            return Some(unit.to_string());
        }
        // The section of units lists only the last channels, which the user added. Other units are
        // the last word of the title in the header.
        let added = (i + units.len()).checked_sub(width);
        let added = added.map(|place| units[place].to_string());
        let title = titles.get(i).filter(|_| titles.len() == width);
        let title = title.copied().unwrap_or_default();
        let last = || Some(title.rsplit_once(' ')?.1.to_string());
        let last = channel(title).unit.or_else(last);
        let unit = |unit: &String| is_unit(unit);
        added.filter(unit).or(last.filter(unit))
    };
    let of = |(i, name): (usize, &&str)| Channel {
        name: shown_name(name),
        unit: unit_of(i, name),
        ..Channel::default()
    };
    let start = head[..rows].iter().map(|line| line.len()).sum();
    let mut first_rows = text[start..].lines().take(WINDOW);
    Some(Layout {
        delimiter: b' ',
        decimal_comma: first_rows.any(|line| line.contains(',')),
        channels: names.iter().enumerate().map(of).collect(),
        sources: vec![String::new(); width],
        head: Vec::new(),
        start,
        first_row: rows as u64 + 1,
        score: 1,
        vbox: true,
    })
}

/// The channel of a name with its unit: `Speed [km/h]` is named `Speed`. Without brackets the name
/// is unchanged and its unit is the one that it ends in.
fn channel(cell: &str) -> Channel {
    let mut channel = Channel {
        name: shown_name(cell),
        unit: name_unit(cell),
        ..Channel::default()
    };
    for (open, close) in [('(', ')'), ('[', ']')] {
        if let Some((name, rest)) = cell.rsplit_once(open)
            && let Some(unit) = rest.trim_end().strip_suffix(close)
            && !name.trim().is_empty()
            && (open == '[' || is_unit(unit))
        {
            channel.name = shown_name(name);
            channel.unit = Some(unit.trim().to_string());
        }
    }
    channel
}

/// Share of the non-empty cells that are units. Most single letters count half, since they may be
/// names.
fn unit_share(cells: &[&str]) -> f64 {
    let filled: Vec<&&str> = cells.iter().filter(|cell| !cell.is_empty()).collect();
    let share = |cell: &&&str| match cell.as_bytes() {
        _ if !is_unit(cell) => 0.0,
        [b's' | b'm' | b'g' | b'G'] => 1.0,
        [letter] if letter.is_ascii_alphabetic() => 0.5,
        _ => 1.0,
    };
    filled.iter().map(share).sum::<f64>() / filled.len().max(1) as f64
}

fn is_units(cells: &[&str]) -> bool {
    unit_share(cells) > 0.6
}

/// Reads a text file block by block: the channels named in `wanted`, or all channels of numbers.
///
/// A last line without line end, as a logger that loses power writes it, is not read; a remark is
/// added. Times of day continue after midnight. If no channels are named and the file contains more
/// than `max_numbers` numbers, only its first rows are read; a remark is added.
///
/// # Errors
/// [`Error::File`] if there are no rows of numbers, no channel, a row with more cells than names,
/// or more than `max_numbers` numbers in the wanted channels; [`Error::Cell`] for text in a wanted
/// channel.
pub fn read_text(
    reader: impl Read,
    options: TextOptions,
    wanted: Option<&[&str]>,
    max_numbers: u64,
    file: &str,
) -> Result<Log, Error> {
    let failure = |error: std::io::Error| Error::file(file, error);
    let mut source = Text::new(reader).map_err(failure)?;
    while !source.ended && source.text.len() < MAX_WINDOW_BYTES {
        source.read_more().map_err(failure)?;
    }
    let window = if source.ended {
        source.text.len()
    } else {
        source.whole_lines()
    };
    let layout = layout_of(&source.text[..window], options, file)?;
    source.text.drain(..layout.start);
    let (delimiter, mut line) = (layout.delimiter, layout.first_row);
    let mut columns = Columns::new(layout, wanted, max_numbers, file)?;
    loop {
        // A last line without line end may be cut within its last number.
        let end = if source.ended {
            source.whole_lines()
        } else {
            source.text.len()
        };
        let mut rows = Rows {
            text: &source.text[..end],
            at: 0,
            line,
            delimiter,
        };
        let mut used = 0;
        while let Some(row) = rows.next() {
            // The ends of the row and of its quoted cells depend on the text that follows.
            if !source.ended && rows.at + MAX_CELL_BYTES > end {
                break;
            }
            if !columns.take(&row)? {
                let only = format!(
                    "only the rows before row {} are read, {max_numbers} numbers",
                    row.line
                );
                columns.log.remarks.push(format!("{file}: {only}"));
                return columns.log();
            }
            (used, line) = (rows.at.min(end), rows.line);
        }
        if source.ended {
            let blanks = ['\0', '\u{1a}', ' ', '\t', '\r'];
            if !source.text[end..].trim_matches(blanks).is_empty() {
                line += source.text[used..end].matches('\n').count() as u64;
                columns.log.remarks.push(format!(
                    "{file}: row {line}, the last, has no line end and is not read: it may be cut short"
                ));
            }
            return columns.log();
        }
        if used == 0 && source.text.len() > MAX_ROW_BYTES {
            let reason =
                format!("row {line}: longer than {MAX_ROW_BYTES} bytes, expected a shorter row");
            return Err(Error::file(file, reason));
        }
        source.text.drain(..used);
        source.read_more().map_err(failure)?;
    }
}

/// The columns of a file while they are read.
struct Columns<'a> {
    file: &'a str,
    layout: Layout,
    log: Log,
    /// Whether all columns of numbers are read, rather than those named.
    any: bool,
    /// Which columns are read.
    read: Vec<bool>,
    /// Which columns are times of day.
    clocks: Vec<bool>,
    /// A message about the first column that is not read since it contains text.
    refused: Option<String>,
    /// How many more numbers may be read.
    room: u64,
    /// Number of rows with fewer cells than names.
    short_rows: u64,
    /// Line number of the first such row.
    first_short: Option<u64>,
}

impl<'a> Columns<'a> {
    fn new(
        mut layout: Layout,
        wanted: Option<&[&str]>,
        max_numbers: u64,
        file: &'a str,
    ) -> Result<Self, Error> {
        let mut log = Log {
            channels: std::mem::take(&mut layout.channels),
            ..Log::default()
        };
        let column = |i: usize| format!("column {}", i + 1);
        log.distinguish(|i| match layout.sources[i].as_str() {
            "" => column(i),
            source => source.to_string(),
        });
        log.distinguish(column);
        let mut read = vec![wanted.is_none(); log.channels.len()];
        for name in wanted.unwrap_or_default() {
            read[log.find(name, file)?] = true;
        }
        Ok(Self {
            file,
            layout,
            any: wanted.is_none(),
            clocks: vec![false; read.len()],
            read,
            log,
            refused: None,
            room: max_numbers,
            short_rows: 0,
            first_short: None,
        })
    }

    /// Adds a row. Returns `false` if all columns of numbers are read and the row would exceed the
    /// maximum.
    ///
    /// If all columns of numbers are read, a column that contains text is dropped.
    ///
    /// # Errors
    /// As [`read_text`].
    fn take(&mut self, Row { line, cells, .. }: &Row) -> Result<bool, Error> {
        let width = self.read.len();
        let repeated =
            |head: &Vec<String>| head.iter().map(String::as_str).eq(cells.iter().copied());
        let comment = cells.len() != width && cells[0].starts_with('#');
        if self.layout.head.iter().any(repeated) || comment {
            return Ok(true);
        }
        let found = cells.len();
        if cells.iter().skip(width).any(|cell| !cell.is_empty()) {
            let wrong =
                format!("row {line}: found {found} cells, expected {width}, one below each name");
            return Err(Error::file(self.file, wrong));
        }
        if found < width {
            self.short_rows += 1;
            self.first_short.get_or_insert(*line);
        }
        let count = self.read.iter().filter(|read| **read).count() as u64;
        self.room = match self.room.checked_sub(count) {
            Some(room) => room,
            None if self.any => return Ok(false),
            None => return Err(Error::too_many(self.file)),
        };
        self.log.lines.push(*line);
        for (i, cell) in cells
            .iter()
            .chain(iter::repeat(&""))
            .take(width)
            .enumerate()
        {
            if !self.read[i] {
                continue;
            }
            let channel = &mut self.log.channels[i];
            if let Some(number) = Number::of(cell, self.layout.decimal_comma) {
                self.clocks[i] |= number.is_clock;
                channel.values.push(number.value);
            } else if self.any {
                let name = &channel.name;
                let reason = || format!("column {name:?} has {cell:?} in row {line}");
                self.refused.get_or_insert_with(reason);
                channel.values = Vec::new();
                self.read[i] = false;
            } else {
                return Err(Error::Cell {
                    file: self.file.to_string(),
                    row: *line,
                    channel: channel.name.clone(),
                    found: cell.to_string(),
                    expected: "a number",
                });
            }
        }
        Ok(true)
    }

    /// The recording, with times in seconds and positions in degrees.
    ///
    /// # Errors
    /// As [`read_text`].
    fn log(self) -> Result<Log, Error> {
        let (mut log, vbox) = (self.log, self.layout.vbox);
        if let Some(line) = self.first_short {
            let (file, rows) = (self.file, self.short_rows);
            log.remarks.push(format!(
                "{file}: {rows} rows, the first of them row {line}, have fewer cells than there are names: the others are missing values"
            ));
        }
        for (channel, clock) in log.channels.iter_mut().zip(self.clocks) {
            channel.values.shrink_to_fit();
            let name = channel.name.to_lowercase();
            let packed = name == "time" && vbox
                || (name.contains("time") || name.contains("utc")) && is_packed(&channel.values);
            if packed {
                channel.values.iter_mut().for_each(|t| *t = unpacked(*t));
            }
            if clock || packed {
                channel.unit = Some("s".to_string());
                continue_days(&mut channel.values, false);
            }
            let to_degrees = match name.as_str() {
                "lat" | "latitude" if vbox => 1.0 / 60.0,
                "long" | "longitude" if vbox => -1.0 / 60.0,
                _ => continue,
            };
            channel.values.iter_mut().for_each(|x| *x *= to_degrees);
        }
        if self.any {
            let mut read = self.read.into_iter();
            log.channels.retain(|_| read.next().unwrap_or(false));
            log.channels.retain(|channel| !channel.name.is_empty());
        }
        let refused = self.refused.as_deref().unwrap_or("no column has a name");
        log.with_channels(self.file, refused)
    }
}

/// Whether times are written as `hhmmss.ss`: all minutes and seconds are below 60, and the times
/// jump from the end of a minute to the start of the next, as plain seconds would not.
fn is_packed(values: &[f64]) -> bool {
    let fits = |t: &f64| {
        *t >= 0.0 && *t < 240_000.0 && t % 100.0 < 60.0 && (t / 100.0).floor() % 100.0 < 60.0
    };
    let finite = || values.iter().filter(|t| t.is_finite());
    if !finite().all(fits) {
        return false;
    }
    let times: Vec<f64> = finite().copied().collect();
    let crosses =
        |pair: &&[f64]| pair[0] % 100.0 > 50.0 && pair[1] % 100.0 < 10.0 && pair[1] > pair[0];
    let crossing = times.windows(2).find(crosses);
    crossing.is_some_and(|pair| unpacked(pair[1]) - unpacked(pair[0]) < 20.0)
}

/// Converts `hhmmss.ss` to seconds.
fn unpacked(packed: f64) -> f64 {
    // Rounding restores the decimals of the seconds as they were written.
    let (hours, minutes) = ((packed / 1e4).floor(), (packed / 100.0).floor() % 100.0);
    let seconds = packed - 1e4 * hours - 100.0 * minutes;
    3600.0 * hours + 60.0 * minutes + (seconds * 1e6).round() / 1e6
}

/// Adds a day to times [s] after each midnight. A midnight is where times fall by more than half a
/// day or, if `exact`, where they fall and a day more is within two steps of the time before.
pub(crate) fn continue_days(times: &mut [f64], exact: bool) {
    let (mut last, mut step, mut added) = (f64::NAN, 0.0, 0.0);
    for t in times.iter_mut().filter(|t| t.is_finite()) {
        let later = *t + added - last;
        let is_midnight = if exact {
            later < 0.0 && later + DAY > 0.0 && later + DAY < 2.0 * step
        } else {
            later < -0.5 * DAY
        };
        if is_midnight {
            added += DAY;
        }
        *t += added;
        step = *t - last;
        last = *t;
    }
}

#[cfg(test)]
mod tests {
    use kufe_sled::MOST_NUMBERS;

    use super::*;

    fn read(text: &str, wanted: Option<&[&str]>) -> Result<Log, Error> {
        let options = TextOptions::default();
        read_text(text.as_bytes(), options, wanted, MOST_NUMBERS, "a.csv")
    }

    fn names(text: &str) -> Vec<(String, Option<String>)> {
        let layout = layout_of(text, TextOptions::default(), "a.csv").unwrap();
        let channels = layout.channels.into_iter();
        channels
            .map(|channel| (channel.name, channel.unit))
            .collect()
    }

    #[test]
    fn cells_are_numbers_times_nothing_or_text() {
        let number = |cell, comma| Number::of(cell, comma).map(|number| number.value);
        for (cell, comma, value) in [
            (" -1.5e-3", false, Some(-1.5e-3)),
            ("-0,75", true, Some(-0.75)),
            ("-0,75", false, None),
            ("1,2,3", true, None),
            ("1.234,5", true, Some(1234.5)),
            ("1,234.5", false, Some(1234.5)),
            ("13:05:59.125", false, Some(13.0 * 3600.0 + 359.125)),
            ("01:02,5", true, Some(62.5)),
            ("1970-01-02T00:00:01.5Z", false, Some(86_401.5)),
            ("1970-01-02 00:00:01+01:00", false, Some(86_401.0)),
            ("01.03.2000 00:00:00", false, Some(951_868_800.0)),
            ("2000/02/29 00:01", false, Some(951_782_460.0)),
            ("3/1/2000 1:00:00 PM", false, Some(46_800.0)),
            ("12:00:01 AM", false, Some(1.0)),
            ("12:x", false, None),
            ("1:2:3:4", false, None),
            ("fast", false, None),
            ("1.2.3", false, None),
            ("2021-13-01 00:00:00", false, None),
            ("1e309", false, None),
            ("-1,5e400", true, None),
        ] {
            assert_eq!(number(cell, comma), value, "{cell}");
        }
        for nothing in [
            "", "  ", "NaN", "-", "n/a", "#N/A", "1.#QNAN", "-1.#IND", "NULL", "1.#INF", "inf",
        ] {
            assert!(number(nothing, false).unwrap().is_nan(), "{nothing:?}");
        }
    }

    #[test]
    fn the_degree_sign_is_read_in_every_encoding() {
        let wide = |text: &str, of: fn(u16) -> [u8; 2]| -> Vec<u8> {
            text.encode_utf16().flat_map(of).collect()
        };
        for bytes in [
            "s°/s".as_bytes().to_vec(),
            "\u{feff}s°/s".as_bytes().to_vec(),
            vec![b's', 0xb0, b'/', b's'],
            wide("\u{feff}s°/s", u16::to_be_bytes),
            wide("\u{feff}s°/s", u16::to_le_bytes),
            wide("s°/s", u16::to_be_bytes),
            wide("s°/s", u16::to_le_bytes),
        ] {
            let mut text = Text::new(&bytes[..]).unwrap();
            text.read_more().unwrap();
            assert_eq!(text.text, "s°/s", "{bytes:?}");
        }
    }

    #[test]
    fn long_files_are_read_a_block_at_a_time() {
        // Blocks end within rows, quotes and letters.
        let rows = 300_000;
        let mut text = String::from("t,note,v\n");
        for k in 0..rows {
            text += &format!("{k},\"é, 𝄞\nbend\",{k}.5\n");
        }
        assert!(text.len() > MAX_WINDOW_BYTES + BLOCK);
        let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let options = TextOptions::default();
        for bytes in [text.as_bytes(), &wide] {
            let log = read_text(bytes, options, Some(&["v"]), MOST_NUMBERS, "a.csv").unwrap();
            let values = &log.channels[2].values;
            let mut numbered = values.iter().enumerate();
            assert_eq!(values.len(), rows);
            assert!(numbered.all(|(k, v)| *v == k as f64 + 0.5));
            assert!(log.remarks.is_empty());
        }
        let first = read_text(text.as_bytes(), options, None, 2001, "a.csv").unwrap();
        assert_eq!(first.channels[1].values.len(), 1000);
        assert_eq!(
            first.remarks,
            ["a.csv: only the rows before row 2002 are read, 2001 numbers"]
        );
        let refused = read_text(text.as_bytes(), options, Some(&["v"]), 1000, "a.csv");
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("24000000 numbers"), "{error}");
        let row = "t,v\n0,1\n".to_string() + &",".repeat(3 * MAX_ROW_BYTES);
        let refused = read_text(row.as_bytes(), options, Some(&["v"]), MOST_NUMBERS, "a.csv");
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("longer than"), "{error}");
    }

    #[test]
    fn a_last_cell_may_be_empty_or_be_none() {
        let names = |text: &str| -> Vec<String> { names(text).into_iter().map(|n| n.0).collect() };
        assert_eq!(names("t,a,b\n0,1,\n1,2,3\n"), ["t", "a", "b"]);
        assert_eq!(names("t,a\n0,1,\n1,2,\n"), ["t", "a"]);
        assert_eq!(names("t,a,\n0,1,\n1,2,\n"), ["t", "a", ""]);
        // g, s and m are units and names; two lines of them are names and units.
        assert_eq!(names("s,g\ns,m\n0,1\n1,2\n"), ["s", "m"]);
        assert_eq!(names("s,g\n0,1\n1,2\n"), ["s", "g"]);
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
            let error = read(text, None).unwrap_err().to_string();
            assert!(error.contains("no row of names"), "{text:?}: {error}");
        }
        let error = read("t;w\n1;2\nx;y\n", None).unwrap_err().to_string();
        assert!(error.contains("column \"t\" has \"x\" in row 3"), "{error}");
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
        let failure = |text: &str, name: &str| read(text, Some(&[name])).unwrap_err().to_string();
        assert_eq!(
            failure("t,v\n0,1\n1,2\n2,fast\n", "v"),
            "a.csv: row 4, channel \"v\": found \"fast\", expected a number"
        );
        assert_eq!(
            failure("t,v\n0,1\n1,2\n2,3,4\n", "v"),
            "a.csv: row 4: found 3 cells, expected 2, one below each name"
        );
        assert_eq!(
            failure("t,v\n0,1\n1,2\n", "w"),
            "a.csv: there is no channel \"w\", expected one of: t, v"
        );
    }

    #[test]
    fn a_last_line_without_its_end_is_left_out_with_a_remark() {
        for last in ["2,3", "2,3,4", "2,3,", "2,3,-"] {
            let text = format!("t,v,w\n0,1,2\n1,2,3\n{last}");
            let log = read(&text, Some(&["v", "w"])).unwrap();
            assert_eq!(log.channels[1].values, [1.0, 2.0], "{last}");
            assert_eq!(log.remarks.len(), 1, "{last}");
            assert!(log.remarks[0].starts_with("a.csv: row 4, the last, has no line end"));
        }
    }
    #[test]
    fn plain_times_continue_after_midnight_and_nowhere_else() {
        let mut times = [86_399.98, 86_399.99, 0.0, 0.01];
        continue_days(&mut times, true);
        assert!((times[3] - 86_400.01).abs() < 1e-9);
        for other in [[86_399.0, 86_399.01, 5.0], [19.97, 19.98, 14.99]] {
            let mut times = other;
            continue_days(&mut times, true);
            assert_eq!(times, other);
        }
    }

    #[test]
    fn cells_that_a_row_lacks_are_missing_values() {
        let log = read("t,v,w\n0,1,2\n1\n2,3\n3,4,5\n", Some(&["v", "w"])).unwrap();
        let [_, v, w] = &log.channels[..] else {
            panic!("{log:?}");
        };
        let there = |x: &[f64]| x.iter().map(|x| x.is_finite()).collect::<Vec<_>>();
        assert_eq!(there(&v.values), [true, false, true, true]);
        assert_eq!(there(&w.values), [true, false, false, true]);
        assert_eq!(
            log.remarks,
            [
                "a.csv: 2 rows, the first of them row 3, have fewer cells than there are names: the others are missing values"
            ]
        );
    }

    #[test]
    fn any_bytes_are_read_or_refused_in_words() {
        // A lone carriage return among blanks, before a letter of two bytes.
        let _ = read("a b\n1 2\n3 \ré\n", None);
        let parts = [
            "1",
            " ",
            ",",
            ";",
            "\t",
            "\r",
            "\n",
            "\"",
            "é",
            "a",
            "[data]\n",
            "\0",
            "-",
            "[column names]\n",
        ];
        let mut state = 1_u32;
        for _ in 0..4000 {
            let mut text = String::new();
            for _ in 0..24 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                text += parts[(state >> 16) as usize % parts.len()];
            }
            let _ = read(&text, None);
            let _ = read(&format!("a b c\n1 2 3\n{text}"), Some(&["b"]));
        }
    }
}
