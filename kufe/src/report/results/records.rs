//! Records as rows of one table, whose columns are all their figures.

use std::borrow::Cow;

use kufe_sled::distinct;

use crate::report::html::{small, table};
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
pub fn records(rows: &[Datum]) -> String {
    let rows: Vec<&Data> = rows.iter().filter_map(Datum::group).collect();
    let shown = &rows[..rows.len().min(MOST_ROWS)];
    let cells: Vec<Vec<Entry>> = shown.iter().map(|row| entries(row)).collect();
    let mut heads = Vec::new();
    let mut texts = vec![Vec::new(); shown.len()];
    for name in distinct(cells.iter().flatten().map(|entry| &entry.name)) {
        let column = cells.iter();
        let column = column.map(|row| row.iter().find(|entry| entry.name == *name));
        let column: Vec<Option<&Entry>> = column.collect();
        let present = || column.iter().flatten();
        let unit = present().next().map_or("".into(), |entry| entry.unit());
        let largest = present().map(|entry| entry.largest()).fold(0.0, f64::max);
        let scale = Scale::of(&unit, largest);
        // Rows that name a column or key have units of their own.
        let names_key = |row: &&Data| row.get("column").or(row.get("key")).is_some();
        let is_own = unit.is_empty() && shown.iter().any(names_key);
        let rows = shown.iter().zip(&cells);
        for ((entry, (row, all)), texts) in column.iter().zip(rows).zip(&mut texts) {
            texts.push(match entry {
                Some(entry) if is_own => {
                    // The row's figures of this unit are read beside one another.
                    let unit = own_unit(row, entry);
                    let alike = all.iter().filter(|other| own_unit(row, other) == unit);
                    let largest = alike.map(Entry::largest).fold(0.0, f64::max);
                    entry.in_unit(&Scale::of(&unit, largest))
                }
                Some(entry) => entry.number(&scale),
                None => String::new(),
            });
        }
        let unit = match &*scale.unit {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        heads.push((
            format!("{name}{unit}"),
            present().all(|entry| entry.is_number()),
        ));
    }
    let heads: Vec<(&str, bool)> = heads.iter().map(|(name, n)| (&**name, *n)).collect();
    let mut out = table(&heads, texts.into_iter().map(|texts| (false, texts)));
    if rows.len() > MOST_ROWS {
        out += &small(&format!("The first {MOST_ROWS} of {}.", rows.len()));
    }
    out
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
