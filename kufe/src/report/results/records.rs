//! Records as rows of one table, whose columns are all their figures.

use std::borrow::Cow;
use std::fmt::Write as _;

use serde_json::{Map, Value};

use crate::report::page::escape;
use crate::report::results::amount::Scale;
use crate::report::results::entry::{Entry, entries, is_table};
use crate::report::results::label::unit_of;

/// Most rows of a table that a page shows.
const MOST_ROWS: usize = 200;

/// The unit of a figure in a row that names the column or key which it is of.
///
/// Where two runs part in their speed, the force that is lacking is told.
fn own_unit(row: &Map<String, Value>, entry: &Entry) -> Cow<'static, str> {
    let of = ["column", "key"]
        .iter()
        .find_map(|key| row.get(*key)?.as_str());
    let unit = entry.unit();
    match (&*unit, of) {
        ("", Some("v_mps")) if entry.key == "size" => Cow::Borrowed("N"),
        ("", Some(of)) if !entry.key.starts_with("times") => unit_of(of),
        _ => unit,
    }
}

/// The table; tables within rows are left to [`within`].
pub fn records(out: &mut String, rows: &[Value]) {
    let rows: Vec<&Map<String, Value>> = rows.iter().filter_map(Value::as_object).collect();
    let shown = &rows[..rows.len().min(MOST_ROWS)];
    let cells: Vec<Vec<Entry>> = shown.iter().map(|row| entries(row)).collect();
    let mut names: Vec<&str> = Vec::new();
    for entry in cells.iter().flatten() {
        if !names.contains(&entry.name.as_str()) {
            names.push(&entry.name);
        }
    }
    let column = |name: &str| -> Vec<Option<&Entry>> {
        let found = |row: &Vec<Entry<'_>>| row.iter().position(|entry| entry.name == name);
        cells.iter().map(|row| Some(&row[found(row)?])).collect()
    };
    let mut columns = Vec::new();
    let mut head = String::new();
    for name in names {
        let column = column(name);
        let there = || column.iter().flatten();
        let unit = there()
            .next()
            .map_or(Cow::Borrowed(""), |entry| entry.unit());
        let scale = Scale::of(
            unit.clone(),
            there().map(|entry| entry.largest()).fold(0.0, f64::max),
        );
        // Rows that tell what they are of have units of their own.
        let own = unit.is_empty()
            && shown
                .iter()
                .any(|row| row.contains_key("column") || row.contains_key("key"));
        let numbers = there().all(|entry| entry.is_number());
        let class = if numbers { " class=n" } else { "" };
        let said = if scale.unit.is_empty() {
            String::new()
        } else {
            format!(" [{}]", escape(&scale.unit))
        };
        let _ = write!(head, "<th{class}>{}{said}", escape(name));
        let texts: Vec<String> = column
            .iter()
            .zip(shown)
            .map(|(entry, row)| match entry {
                Some(entry) if own => {
                    entry.in_unit(&Scale::of(own_unit(row, entry), entry.largest()))
                }
                Some(entry) => entry.number(&scale),
                None => String::new(),
            })
            .collect();
        columns.push((class, texts));
    }
    let _ = writeln!(out, "<div class=\"wide\"><table><tr>{head}");
    for k in 0..shown.len() {
        out.push_str("<tr>");
        for (class, texts) in &columns {
            let _ = write!(out, "<td{class}>{}", texts[k]);
        }
        out.push('\n');
    }
    out.push_str("</table></div>\n");
    if rows.len() > MOST_ROWS {
        let _ = writeln!(
            out,
            "<p><small>The first {MOST_ROWS} of {}.</small></p>",
            rows.len()
        );
    }
}

/// The tables within rows, those of one key as one table: each of their rows begins with the first word of the row that it is of.
pub fn within(rows: &[Value]) -> Vec<(&str, Vec<Value>)> {
    let mut tables: Vec<(&str, Vec<Value>)> = Vec::new();
    for row in rows.iter().filter_map(Value::as_object) {
        let word = row.iter().find(|(_, value)| value.is_string());
        for (key, table) in row.iter().filter(|(_, value)| is_table(value)) {
            let place = tables.iter().position(|(known, _)| known == key);
            let place = place.unwrap_or_else(|| {
                tables.push((key, Vec::new()));
                tables.len() - 1
            });
            let inner = table.as_array().into_iter().flatten();
            for inner in inner.filter_map(Value::as_object) {
                let mut whole: Map<String, Value> = Map::new();
                whole.extend(word.map(|(key, value)| (key.clone(), value.clone())));
                whole.extend(
                    inner
                        .iter()
                        .map(|(key, value)| (key.clone(), value.clone())),
                );
                tables[place].1.push(Value::Object(whole));
            }
        }
    }
    tables
}
