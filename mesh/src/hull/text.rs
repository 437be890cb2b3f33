//! Lines, words and numbers of hulls in text files.

use std::borrow::Cow;
use std::fmt::Display;

use crate::error::MeshError;

/// Longest word that an error message repeats, in characters.
const LONGEST_WORD: usize = 40;

/// Bytes as text without byte order mark; names in other encodings than UTF-8 are read with
/// replacement characters.
pub(crate) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// The lines of a text with their numbers from 1. Lines end with a line feed, with or without a
/// carriage return, or all with a carriage return alone.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.split(end)
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim_ascii()))
}

/// The error of a text that was found at a place of a file.
pub(crate) fn unreadable(
    format: &str,
    place: impl Display,
    found: impl Display,
    expected: impl Display,
) -> MeshError {
    let place = format!("not a readable {format} file: {place}");
    MeshError::value(place, found, expected)
}

/// The error of a word that does not fit.
pub(crate) fn syntax(format: &str, line: usize, found: &str, expected: &str) -> MeshError {
    let found = match found.char_indices().nth(LONGEST_WORD) {
        _ if found.is_empty() => "the end of the line".into(),
        None => format!("{found:?}"),
        Some((end, _)) => format!("{:?}...", &found[..end]),
    };
    unreadable(format, format!("line {line}"), found, expected)
}

/// The next three words as numbers.
pub(crate) fn point<'a>(
    format: &str,
    line: usize,
    mut words: impl Iterator<Item = &'a str>,
) -> Result<[f64; 3], MeshError> {
    let mut point = [0.0; 3];
    for value in &mut point {
        let word = words.next().unwrap_or_default();
        *value = word.parse().map_err(|_| {
            let expected = if word.contains(',') {
                "a coordinate with a decimal point, not a comma"
            } else {
                "a coordinate (three numbers)"
            };
            syntax(format, line, word, expected)
        })?;
    }
    Ok(point)
}
