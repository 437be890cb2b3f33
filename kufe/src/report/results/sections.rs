//! A document as tables: important figures first, further figures folded.

use indexmap::IndexMap;
use kufe_sled::distinct;

use crate::plot::{Scale, escape};
use crate::report::html::{fold, fold_with, small, table};
use crate::report::results::entry::{Entry, entries, with_unit};
use crate::results::label::{is_named, name_of, unit_in};
use crate::results::{Data, Datum};

/// Largest number of rows of a table.
const MAX_ROWS: usize = 200;
/// Largest number of rows of a table that is initially unfolded.
const MAX_OPEN_ROWS: usize = 40;
/// Largest number of further figures that are not folded.
const MAX_UNFOLDED: usize = 2;
/// Fraction of a section's length below which one of its ends is shown as 0.
const ROUNDING: f64 = 1e-5;

/// Keys that are omitted: they are shown elsewhere, or concern files.
const OMITTED: [&str; 3] = ["version", "files", "content_sha256"];
/// Cases are shown as their file states them.
const CASES: [&str; 2] = ["case", "cases"];

/// A document's tables.
pub fn document(document: &Datum) -> String {
    match document {
        Datum::Group(figures) => top(figures),
        Datum::List(rows) => list(rows),
        single => format!("<p>{}</p>\n", escape(&single.to_string())),
    }
}

/// A key and its datum.
type Figure<'a> = (&'a String, &'a Datum);

/// The important figures of a group, then its subgroups and tables, then the further figures.
fn top(figures: &Data) -> String {
    let (cases, shown): (Vec<Figure>, Vec<Figure>) = figures
        .iter()
        .filter(|(key, value)| !OMITTED.contains(&&***key) && **value != Datum::Absent(()))
        .partition(|(key, _)| CASES.contains(&&***key));
    let (nested, single): (Vec<Figure>, Vec<Figure>) = shown
        .into_iter()
        .partition(|(_, value)| value.is_table() || has_parts(value));
    let none = single.iter().filter(|(_, value)| value.is_empty());
    let none = none.map(|(key, _)| format!("{}: none", name_of(key)));
    let none = none.collect::<Vec<_>>().join("; ");
    let (first, further): (Vec<Entry>, Vec<Entry>) = entries(single)
        .into_iter()
        .partition(|entry| is_named(entry.key));
    let mut rest = pairs(&further);
    if !none.is_empty() {
        rest += &format!("<p>{}</p>\n", escape(&none));
    }
    let is_alone = first.is_empty() && nested.is_empty();
    if !(rest.is_empty() || is_alone || further.len() <= MAX_UNFOLDED) {
        rest = fold("Further figures", &rest);
    }
    let cases = cases.into_iter().map(|(key, value)| {
        let list = match value {
            Datum::List(cases) => cases,
            case => std::slice::from_ref(case),
        };
        let tables: String = list.iter().map(as_stated).collect();
        fold(&format!("{}, as stated", capital(key)), &tables)
    });
    pairs(&first) + &parts(nested) + &rest + &cases.collect::<String>()
}

/// Whether a figure is a group of more than a value with its interval.
fn has_parts(figure: &Datum) -> bool {
    let group = figure.group().filter(|_| !figure.is_empty());
    group.is_some_and(|figures| !figures.contains_key("value"))
}

/// Groups and tables under their names, long ones last; groups with equal keys are side by side.
fn parts(mut nested: Vec<Figure>) -> String {
    nested.sort_by_key(|(_, value)| value.list().len() > MAX_OPEN_ROWS);
    // Tables have no keys and are not combined.
    let mut alike: IndexMap<(Vec<&String>, &str), Vec<Figure>> = IndexMap::new();
    for (key, value) in nested {
        let keys = value.group().map(|group| group.keys().collect::<Vec<_>>());
        let own = keys.as_ref().map_or(key.as_str(), |_| "");
        let place = (keys.unwrap_or_default(), own);
        alike.entry(place).or_default().push((key, value));
    }
    let part = |group: &Vec<Figure>| match group[..] {
        [(key, Datum::Group(figures))] => folded(&name_of(key), is_named(key), &top(figures)),
        [(key, value)] => {
            let rows = value.list();
            folded(&name_of(key), rows.len() <= MAX_OPEN_ROWS, &list(rows))
        }
        _ => {
            let names: Vec<String> = group.iter().map(|(key, _)| name_of(key)).collect();
            folded(&names.join(", "), true, &side_by_side(&names, group))
        }
    };
    alike.values().map(part).collect()
}

/// A table of records, and the folded tables within them.
fn list(rows: &[Datum]) -> String {
    let inner = within(rows).into_iter();
    let inner = inner.map(|(key, rows)| folded(&name_of(key), false, &list(&rows)));
    records(rows) + &inner.collect::<String>()
}

/// A fold with a name.
fn folded(name: &str, is_open: bool, inner: &str) -> String {
    fold_with(if is_open { " open" } else { "" }, &capital(name), inner)
}

/// Capitalises the first letter.
pub fn capital(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// A table of names and values with units; empty without data.
fn pairs(figures: &[Entry]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let row = |figure: &Entry| {
        // Both ends of a section are shown in one unit.
        let end = figure.key.replacen("from", "to", 1);
        let ends = figures.iter().filter(|other| other.key == end);
        let length = ends.map(Entry::largest).fold(figure.largest(), f64::max);
        let scale = Scale::of(&figure.unit(), length);
        let text = if figure.largest() < ROUNDING * length {
            with_unit(&scale, "0")
        } else {
            figure.in_unit(&scale)
        };
        [escape(&figure.name), text]
    };
    table(&[], figures.iter().map(row))
}

/// Groups with equal figures, one column per group.
fn side_by_side(heads: &[String], group: &[Figure]) -> String {
    let columns = group.iter().filter_map(|(_, value)| value.group());
    let columns: Vec<Vec<Entry>> = columns.map(entries).collect();
    let row = |name: &String| {
        let cells = columns.iter().map(|column| {
            let entry = column.iter().find(|entry| entry.name == *name);
            entry.map_or(String::new(), Entry::shown)
        });
        [escape(name)].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let heads = [""].into_iter().chain(heads.iter().map(String::as_str));
    let heads: Vec<(&str, bool)> = heads.map(|head| (head, false)).collect();
    let names = distinct(columns.iter().flatten().map(|entry| &entry.name));
    table(&heads, names.into_iter().map(row))
}

/// Records as rows of one table; its columns are all figures of the records except the tables
/// within them (see [`within`]).
fn records(rows: &[Datum]) -> String {
    let rows: Vec<&Data> = rows.iter().filter_map(Datum::group).collect();
    let shown = &rows[..rows.len().min(MAX_ROWS)];
    let cells: Vec<Vec<Entry>> = shown.iter().map(|row| entries(*row)).collect();
    let mut heads = Vec::new();
    let mut texts = vec![Vec::new(); shown.len()];
    for name in distinct(cells.iter().flatten().map(|entry| &entry.name)) {
        let column = cells.iter();
        let column = column.map(|row| row.iter().find(|entry| entry.name == *name));
        let column: Vec<Option<&Entry>> = column.collect();
        let present = || column.iter().flatten();
        let unit = present().next().map_or("".into(), |entry| entry.unit());
        let scale = Scale::of_all(&unit, present().map(|entry| entry.largest()));
        // The unit of a row that names a column or key is that of this column or key.
        let names_key = |row: &&Data| row.get("column").or(row.get("key")).is_some();
        let is_own = unit.is_empty() && shown.iter().any(names_key);
        let rows = shown.iter().zip(&cells);
        for ((entry, (row, all)), texts) in column.iter().zip(rows).zip(&mut texts) {
            texts.push(match entry {
                Some(entry) if is_own => {
                    // Figures of the row with equal units get the same display unit.
                    let unit = unit_in(row, entry.key);
                    let alike = all.iter().filter(|other| unit_in(row, other.key) == unit);
                    entry.in_unit(&Scale::of_all(&unit, alike.map(Entry::largest)))
                }
                Some(entry) => entry.number(&scale),
                None => String::new(),
            });
        }
        heads.push((scale.label(name), present().all(|entry| entry.is_number())));
    }
    let heads: Vec<(&str, bool)> = heads.iter().map(|(name, n)| (&**name, *n)).collect();
    let mut out = table(&heads, texts);
    if rows.len() > MAX_ROWS {
        out += &small(&format!("The first {MAX_ROWS} of {}.", rows.len()));
    }
    out
}

/// The tables within rows, merged by key. Each row of a merged table begins with the first text of
/// the row that contains it.
fn within(rows: &[Datum]) -> IndexMap<&String, Vec<Datum>> {
    let mut tables: IndexMap<&String, Vec<Datum>> = IndexMap::new();
    for row in rows.iter().filter_map(Datum::group) {
        let first = row.iter().find(|(_, value)| value.text().is_some());
        for (key, table) in row.iter().filter(|(_, value)| value.is_table()) {
            let inner = table.list().iter().filter_map(Datum::group);
            let whole = inner.map(|inner| {
                let of = first.filter(|(key, _)| !inner.contains_key(*key));
                let whole = of.into_iter().chain(inner);
                let whole = whole.map(|(key, value)| (key.clone(), value.clone()));
                Datum::Group(whole.collect())
            });
            tables.entry(key).or_default().extend(whole);
        }
    }
    tables
}

/// A case with the keys that its file has.
fn as_stated(case: &Datum) -> String {
    let mut rows = Vec::new();
    stated(&mut rows, "", case);
    table(&[], rows)
}

fn stated(rows: &mut Vec<[String; 2]>, path: &str, value: &Datum) {
    match value {
        Datum::Group(figures) => {
            let dot = if path.is_empty() { "" } else { "." };
            let figures = figures.iter();
            figures.for_each(|(key, value)| stated(rows, &format!("{path}{dot}{key}"), value));
        }
        Datum::List(values) if value.is_table() => {
            let places = values.iter().enumerate();
            places.for_each(|(k, value)| stated(rows, &format!("{path}[{k}]"), value));
        }
        // In the notation of a typed number.
        single => {
            let text = match single.number() {
                Some(x) if x.abs() >= 1e6 => format!("{x:e}"),
                Some(x) => x.to_string(),
                None => escape(&single.to_string()),
            };
            rows.push([escape(path), text]);
        }
    }
}
