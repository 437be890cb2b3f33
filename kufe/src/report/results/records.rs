//! Records as rows of one table, whose columns are all their figures.

use std::borrow::Cow;
use std::fmt::Write as _;

use crate::report::page::escape;
use crate::report::results::amount::Scale;
use crate::report::results::entry::{Entry, entries};
use crate::report::results::label::unit_of;
use crate::results::{Data, Datum};

/// Most rows of a table that a page shows.
const MOST_ROWS: usize = 200;

/// The unit of a figure in a row that names the column or key which it is of.
///
/// Where the speeds of two runs differ, the size is the missing force.
fn own_unit(row: &Data, entry: &Entry) -> Cow<'static, str> {
    let of = ["column", "key"]
        .iter()
        .find_map(|key| row.get(key)?.text());
    let unit = entry.unit();
    match (&*unit, of) {
        ("", Some("v_mps")) if entry.key == "size" => Cow::Borrowed("N"),
        ("", Some(of)) if !entry.key.starts_with("times") => unit_of(of),
        _ => unit,
    }
}

/// The table; tables within rows are those of [`within`].
pub fn records(out: &mut String, rows: &[Datum]) {
    let rows: Vec<&Data> = rows.iter().filter_map(Datum::group).collect();
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
        let present = || column.iter().flatten();
        let unit = present()
            .next()
            .map_or(Cow::Borrowed(""), |entry| entry.unit());
        let scale = Scale::of(
            unit.clone(),
            present().map(|entry| entry.largest()).fold(0.0, f64::max),
        );
        // Rows that name a column or key have units of their own.
        let own = unit.is_empty()
            && shown
                .iter()
                .any(|row| row.get("column").or(row.get("key")).is_some());
        let numbers = present().all(|entry| entry.is_number());
        let class = if numbers { " class=n" } else { "" };
        let unit = if scale.unit.is_empty() {
            String::new()
        } else {
            format!(" [{}]", escape(&scale.unit))
        };
        let _ = write!(head, "<th{class}>{}{unit}", escape(name));
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

/// The tables within rows, those of one key as one table: each of their rows begins with the first
/// text of the row that it belongs to.
pub fn within(rows: &[Datum]) -> Vec<(&str, Vec<Datum>)> {
    let mut tables: Vec<(&str, Vec<Datum>)> = Vec::new();
    for row in rows.iter().filter_map(Datum::group) {
        let first = row.iter().find(|(_, value)| value.text().is_some());
        let first = first.map(|(key, value)| (key.to_owned(), value.clone()));
        for (key, table) in row.iter().filter(|(_, value)| value.is_table()) {
            let place = tables.iter().position(|(known, _)| *known == key);
            let place = place.unwrap_or_else(|| {
                tables.push((key, Vec::new()));
                tables.len() - 1
            });
            for inner in table.list().iter().filter_map(Datum::group) {
                let of = first.iter().filter(|(key, _)| inner.get(key).is_none());
                let whole = of.chain(&inner.0).cloned().collect();
                tables[place].1.push(Datum::Group(Data(whole)));
            }
        }
    }
    tables
}
