//! Errors of a case file.

use toml::de::{DeTable, DeValue};

use crate::case::range::{RANGES, Range};

/// Errors of a case file.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The text is not valid TOML, a key is unknown or missing, or a value has the wrong type.
    #[error("{0}")]
    Syntax(String),
    /// A value is outside its range.
    #[error("{}{key} = {value}: expected {expected}", place(*line))]
    OutOfRange {
        /// Line, counted from 1; 0 where the key is not in the file.
        line: usize,
        /// Dotted key.
        key: &'static str,
        /// The value found.
        value: String,
        /// The expected value.
        expected: String,
    },
    /// Two keys exclude each other, or one needs the other.
    #[error("{}{key}: {expected}", place(*line))]
    Combination {
        /// Line, counted from 1; 0 where the key is not in the file.
        line: usize,
        /// Dotted key.
        key: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// An `[effects.NAME]` table is invalid.
    #[error("[effects.{name}]: found {found}, expected {expected}")]
    Effect {
        /// The effect.
        name: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The shape's dimensions do not fit together.
    #[error("runner.shape: {0}")]
    Shape(#[from] kufe_mesh::MeshError),
    /// A file that the case names cannot be read, or is not a valid runner or ice surface.
    #[error("{key}: {source}")]
    File {
        /// Dotted key of the file.
        key: &'static str,
        /// Error of the file.
        source: kufe_mesh::MeshError,
    },
    /// The runner's mesh cannot be read, or is not a valid runner.
    #[error("runner.mesh: {reason}")]
    Mesh {
        /// Message of the reader, with the file.
        reason: String,
    },
    /// The case cannot be written as TOML.
    #[error("the case cannot be written as TOML: {reason}")]
    Unwritable {
        /// Message of the writer.
        reason: String,
    },
}

fn place(line: usize) -> String {
    if line == 0 {
        String::new()
    } else {
        format!("line {line}: ")
    }
}

impl CaseError {
    /// Converts an error of the file of a key.
    pub(super) fn in_file(key: &'static str) -> impl Fn(kufe_mesh::MeshError) -> CaseError {
        move |source| CaseError::File { key, source }
    }

    /// The error for the first value in `text` that is no table where a table is expected. The
    /// deserializer would take an array for the values of the table's keys, in their order.
    pub(super) fn not_a_table(text: &str) -> Option<CaseError> {
        let root = DeTable::parse(text).ok()?;
        let (key, span, found) = value_for_table(root.get_ref(), "")?;
        let form = if LISTS.contains(&&*key) {
            format!("[[{key}]]")
        } else {
            format!("[{key}]")
        };
        let message = format!("found {found}, expected a table: `{form}` and its keys below");
        let message = kufe_files::broken_at(text, Some(span), &message);
        Some(CaseError::Syntax(message))
    }

    /// Converts an error of the TOML reader into one line with its place.
    pub(super) fn from_toml(text: &str, error: &toml::de::Error) -> CaseError {
        let span = error.span().unwrap_or(0..0);
        let root = DeTable::parse(text).ok();
        if let Some(wrong) = root.and_then(|root| text_for_number(root.get_ref(), "", &span)) {
            return wrong.locate(text);
        }
        CaseError::Syntax(kufe_files::broken_at(text, Some(span), error.message()))
    }

    /// The same error with the line of its key in `text`.
    pub(super) fn locate(mut self, text: &str) -> CaseError {
        if let CaseError::OutOfRange { line, key, .. } | CaseError::Combination { line, key, .. } =
            &mut self
        {
            *line = line_of(text, key).unwrap_or(0);
        }
        self
    }
}

/// Keys of arrays of tables.
const LISTS: [&str; 2] = ["runner.mount.held", "runner.mount.carries"];

/// The first value that is no table although the keys of `RANGES` lie below its key: its dotted key,
/// the place of the key in the text, and what the value is.
fn value_for_table(
    table: &DeTable,
    within: &str,
) -> Option<(String, std::ops::Range<usize>, &'static str)> {
    table.iter().find_map(|(name, value)| {
        let key = format!("{within}{}", name.get_ref());
        let below = format!("{key}.");
        let found = match value.get_ref() {
            DeValue::Table(inner) => return value_for_table(inner, &below),
            DeValue::Array(items) if LISTS.contains(&&*key) => {
                let is_table = |item: &DeValue| matches!(item, DeValue::Table(_));
                items.iter().find(|item| !is_table(item.get_ref()))?;
                "an item that is none"
            }
            DeValue::Array(_) => "an array",
            _ => "a single value",
        };
        let is_table = RANGES.iter().any(|range| range.key.starts_with(&below));
        is_table.then(|| (key, name.span(), found))
    })
}

/// The error for the first string within `span` where a number with a range is expected.
fn text_for_number(
    table: &DeTable,
    within: &str,
    span: &std::ops::Range<usize>,
) -> Option<CaseError> {
    table.iter().find_map(|(name, value)| {
        let key = format!("{within}{}", name.get_ref());
        let inside = span.start <= value.span().start && value.span().end <= span.end;
        match value.get_ref() {
            DeValue::String(text) if inside => {
                // A thickness may be a word.
                let range = Range::find(&key).filter(|_| key != "ice.thickness_m")?;
                Some(CaseError::OutOfRange {
                    line: 0,
                    key: range.key,
                    value: format!("{text:?}"),
                    expected: range.expected(),
                })
            }
            DeValue::Table(inner) => text_for_number(inner, &format!("{key}."), span),
            DeValue::Array(items) => items.iter().find_map(|item| match item.get_ref() {
                DeValue::Table(inner) => text_for_number(inner, &format!("{key}."), span),
                _ => None,
            }),
            _ => None,
        }
    })
}

fn line_at(text: &str, span: std::ops::Range<usize>) -> usize {
    let before = &text.as_bytes()[..span.start.min(text.len())];
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

/// Line of a dotted key, or of its nearest table.
fn line_of(text: &str, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut table = root.get_ref();
    let mut found = None;
    for part in key.split('.') {
        let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref() == part) else {
            break;
        };
        found = Some(line_at(text, name.span()));
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => break,
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use crate::case::Case;

    #[test]
    fn arrays_and_values_in_place_of_tables_are_refused_with_the_table_expected() {
        let case = "[runner]\n\
            shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
            [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
            [load]\nfz_n = 1000.0\n";
        Case::parse(case).unwrap();
        let shape = case.find("shape").unwrap()..case.find("[ice]").unwrap();
        let with_shape = |shape_text: &str| case.replace(&case[shape.clone()], shape_text);
        let carries = "[runner.mount]\ncarries = [[0.1, 0.05, 0.5]]\n";
        for (text, expected) in [
            (
                case.replace("[load]", "[[load]]"),
                "found an array, expected a table: `[load]`",
            ),
            (case.replace("[ice]", "[[ice]]"), "`[ice]`"),
            (
                with_shape("shape = [\"paraboloid\", 30.0, 0.005]\n"),
                "expected a table: `[runner.shape]`",
            ),
            (
                with_shape("shape = \"paraboloid\"\n"),
                "found a single value, expected a table: `[runner.shape]`",
            ),
            (
                format!("track = [40.0]\n{case}"),
                "line 1: `track = [40.0]`: found an array",
            ),
            (
                format!("{case}{carries}"),
                "expected a table: `[[runner.mount.carries]]`",
            ),
        ] {
            let error = Case::parse(&text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
