//! Formatting of documents as text for the terminal.

use kufe::jobs::Failure;
use kufe::plot::{Scale, number4, percent, quantity};
use kufe::results::{Data, Datum, QUANTITIES, error_in, measured_in, unit_in, without_unit};
use serde::Serialize;

use crate::terminal::Global;

/// A document as text: groups as indented `key: value` lines, lists of groups as tables. Numbers
/// have their errors and their unit, which is omitted from the key.
///
/// # Errors
/// [`Failure::BadInput`] for a document that cannot be written as JSON.
pub fn document_text(document: &impl Serialize) -> Result<String, Failure> {
    Ok(text(&Datum::of(document)?, 0))
}

/// Rows as a table of these columns; columns that no row has are omitted.
///
/// # Errors
/// As [`document_text`].
pub fn table_text(rows: &impl Serialize, columns: &[&str]) -> Result<String, Failure> {
    Ok(table(Datum::of(rows)?.list(), columns, ""))
}

/// Prints the result of an action, as JSON or as text.
///
/// # Errors
/// As [`document_text`].
pub fn print_document(document: &impl Serialize, global: &Global) -> Result<(), Failure> {
    let text = document_text(document)?;
    global.print(document, || text)
}

fn text(datum: &Datum, depth: usize) -> String {
    let indent = "  ".repeat(depth);
    let data = match datum {
        Datum::Group(data) => data,
        Datum::List(list) if datum.is_table() => return table(list, &[], &indent),
        Datum::List(list) => return list.iter().map(|one| text(one, depth)).collect(),
        other => return format!("{indent}{other}\n"),
    };
    let line = |(key, datum): (&String, &Datum)| match amount(data, key) {
        Some(amount) => format!("{indent}{}: {amount}\n", without_unit(key)),
        None => format!("{indent}{}:\n{}", without_unit(key), text(datum, depth + 1)),
    };
    let shown = data.iter().filter(|(key, _)| !is_error(data, key));
    shown.map(line).collect()
}

/// Rows as a table of these columns, or of all keys whose values fit on a line.
fn table(rows: &[Datum], columns: &[&str], indent: &str) -> String {
    let rows: Vec<&Data> = rows.iter().filter_map(Datum::group).collect();
    let has = |key: &str| rows.iter().any(|row| row.get(key).is_some());
    let mut columns: Vec<&str> = columns.iter().copied().filter(|key| has(key)).collect();
    if columns.is_empty() {
        let fits = |row: &&Data, key: &str| {
            row.get(key).is_none() || amount(row, key).is_some() && !is_error(row, key)
        };
        for (key, _) in rows.iter().flat_map(|row| row.iter()) {
            if !columns.contains(&&**key) && rows.iter().all(|row| fits(row, key)) {
                columns.push(key);
            }
        }
    }
    let columns: Vec<Vec<String>> = columns.iter().map(|key| column(&rows, key)).collect();
    let line = |k: usize| columns.iter().map(|column| column[k].clone()).collect();
    let lines: Vec<Vec<String>> = (0..=rows.len()).map(line).collect();
    aligned(&lines, indent)
}

/// The head and the cells of a column: numbers of one unit have it in the head.
fn column(rows: &[&Data], key: &str) -> Vec<String> {
    let units = rows.iter().map(|row| unit_in(row, key));
    let unit = units.reduce(|a, b| if a == b { a } else { "".into() });
    let unit = unit.unwrap_or_default();
    let present: Vec<&Datum> = rows.iter().filter_map(|row| row.get(key)).collect();
    let numbers: Option<Vec<f64>> = present.iter().map(|datum| datum.number()).collect();
    let Some(numbers) = numbers.filter(|_| !unit.is_empty()) else {
        let cells = rows.iter().map(|row| amount(row, key).unwrap_or_default());
        return std::iter::once(key.to_owned()).chain(cells).collect();
    };
    let finite = numbers.into_iter().filter(|number| number.is_finite());
    let scale = Scale::of_all(&unit, finite);
    let cells = rows.iter().map(|row| {
        let value = row.get(key).and_then(Datum::number);
        value.map_or(String::new(), |value| {
            scale.with_error(value, error_in(row, key).unwrap_or(0.0))
        })
    });
    std::iter::once(scale.label(without_unit(key)))
        .chain(cells)
        .collect()
}

/// Rows of cells, each column as wide as the widest of its cells, and each row on one line.
pub fn aligned(rows: &[impl AsRef<[String]>], indent: &str) -> String {
    let mut lines = vec![indent.to_owned(); rows.len()];
    for column in 0..rows.first().map_or(0, |row| row.as_ref().len()) {
        let cells = rows
            .iter()
            .map(|row| row.as_ref()[column].replace('\n', "\\n"));
        let wide = cells.clone().map(|cell| cell.chars().count()).max();
        let wide = wide.unwrap_or_default();
        for (line, cell) in lines.iter_mut().zip(cells) {
            *line += &format!("{cell:<wide$}  ");
        }
    }
    let lines = lines.iter().map(|line| format!("{}\n", line.trim_end()));
    lines.collect()
}

/// Whether a key is that of the error of another number.
fn is_error(data: &Data, key: &str) -> bool {
    let of = QUANTITIES.iter().find(|known| known.error_key == key);
    of.is_some_and(|known| measured_in(data, known.key).is_some())
}

/// What fits on a line: a number with its error, a single datum, a range, a list of such.
fn amount(data: &Data, key: &str) -> Option<String> {
    let (datum, unit) = (data.get(key)?, unit_in(data, key));
    let is_sentence = |datum: &Datum| datum.text().is_some_and(|text| text.contains(' '));
    match datum {
        Datum::Group(inner) => range(&unit, datum, inner),
        Datum::List(list) if datum.is_table() || list.iter().any(is_sentence) => None,
        other => Some(measured_in(data, key).unwrap_or_else(|| single(&unit, other))),
    }
}

/// Single data on a line: words as they are, numbers with their unit, lists of them.
fn single(unit: &str, datum: &Datum) -> String {
    match datum {
        Datum::List(list) if !list.is_empty() => {
            let is_nested = list.iter().any(|one| !one.is_single());
            let each: Vec<String> = list.iter().map(|one| single(unit, one)).collect();
            each.join(if is_nested { "; " } else { ", " })
        }
        other if other.is_empty() => "none".to_owned(),
        other => match other.number() {
            Some(number) => with_unit(unit, number),
            None => other.to_string(),
        },
    }
}

/// A number with its unit; whole ones without a unit in full.
fn with_unit(unit: &str, number: f64) -> String {
    match unit {
        "" if number.fract() == 0.0 && number.abs() < 1e15 => number.to_string(),
        "" => number4(number),
        unit => quantity(number, unit),
    }
}

/// "2 points, from 12 m/s, to 31 m/s" of a range; "12 N (11 to 13 N)" of a value with its
/// interval.
fn range(unit: &str, datum: &Datum, inner: &Data) -> Option<String> {
    if let Some([value, low, high]) = datum.interval() {
        let scale = Scale::of_all(unit, [value, high]);
        let [value, low, high] = [value, low, high].map(|number| scale.number(number));
        return Some(if low == high {
            scale.with_unit(&value)
        } else {
            scale.with_unit(&format!("{value} ({low} to {high})"))
        });
    }
    let part = |(name, datum): (&String, &Datum)| {
        let number = datum.number();
        Some(match &**name {
            _ if datum.is_empty() => String::new(),
            "points" | "missing" => format!("{datum} {name}"),
            "from" | "to" | "min" | "max" => format!("{name} {}", with_unit(unit, number?)),
            "smooth_error" | "bilinear_error" => {
                let (mode, _) = name.split_once('_')?;
                format!("{mode} within {}", percent(number?))
            }
            "outside" => format!("outside: {datum}"),
            _ => return None,
        })
    };
    let mut parts = inner.iter().map(part).collect::<Option<Vec<String>>>()?;
    parts.retain(|part| !part.is_empty());
    Some(if parts.is_empty() {
        "none".to_owned()
    } else {
        parts.join(", ")
    })
}

#[cfg(test)]
mod tests {
    use super::aligned;

    #[test]
    fn a_name_with_a_line_break_stays_on_its_line() {
        let rows = [["a\nb", "1"], ["c", "2"]].map(|row| row.map(str::to_string));
        assert_eq!(aligned(&rows, ""), "a\\nb  1\nc     2\n");
    }
}
