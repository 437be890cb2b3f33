//! A document as tables: what matters most first and open, the rest folded.

use kufe_sled::distinct;

use crate::plot::escape;
use crate::report::html::{fold, fold_with, table};
use crate::report::results::amount::Scale;
use crate::report::results::entry::{Entry, entries};
use crate::report::results::label::{is_named, name_of};
use crate::report::results::records::{records, within};
use crate::results::{Data, Datum};

/// Longest table that is open.
const OPEN_ROWS: usize = 40;
/// So many further figures need no fold.
const FEW: usize = 2;
/// An end of a section that is less of its length than this is its beginning.
const NOTHING: f64 = 1e-5;

/// What a page shows elsewhere, or what concerns files rather than their content.
const ASIDE: [&str; 3] = ["version", "files", "content_sha256"];
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

/// The figures of a group, then its parts, then the further figures.
fn top(figures: &Data) -> String {
    let is_shown = |(key, value): &(&str, &Datum)| {
        !ASIDE.contains(key) && !CASES.contains(key) && **value != Datum::Absent(())
    };
    let (nested, single): (Vec<_>, Vec<_>) = figures
        .iter()
        .filter(is_shown)
        .partition(|(_, value)| value.is_table() || has_parts(value));
    let none = single.iter().filter(|(_, value)| value.is_empty());
    let none: Vec<String> = none
        .map(|(key, _)| format!("{}: none", name_of(key)))
        .collect();
    let single = single
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value.clone()));
    let single = Data(single.collect());
    let (first, further): (Vec<Entry>, Vec<Entry>) = entries(&single)
        .into_iter()
        .partition(|entry| is_named(entry.key));
    let mut out = pairs(&first) + &parts(&nested);
    let mut rest = pairs(&further);
    if !none.is_empty() {
        rest += &format!("<p>{}</p>\n", escape(&none.join("; ")));
    }
    if !rest.is_empty() {
        let is_alone = first.is_empty() && nested.is_empty();
        out += &if is_alone || further.len() <= FEW {
            rest
        } else {
            fold("Further figures", &rest)
        };
    }
    for (key, value) in figures.iter().filter(|(key, _)| CASES.contains(key)) {
        let cases = match value {
            Datum::List(cases) => cases,
            case => std::slice::from_ref(case),
        };
        let cases: String = cases.iter().map(as_stated).collect();
        out += &fold(&format!("{}, as stated", capital(key)), &cases);
    }
    out
}

/// Whether a figure is a group of more than a value with its interval.
fn has_parts(figure: &Datum) -> bool {
    let group = figure.group().filter(|_| !figure.is_empty());
    group.is_some_and(|figures| figures.get("value").is_none())
}

/// Groups and tables under their names, long ones last; groups of the same keys side by side.
fn parts(nested: &[(&str, &Datum)]) -> String {
    let mut nested = nested.to_vec();
    nested.sort_by_key(|(_, value)| value.list().len() > OPEN_ROWS);
    let keys = |value: &Datum| -> Option<Vec<String>> {
        Some(
            value
                .group()?
                .iter()
                .map(|(key, _)| key.to_owned())
                .collect(),
        )
    };
    let mut out = String::new();
    let mut done: Vec<&str> = Vec::new();
    for (key, value) in &nested {
        if done.contains(key) {
            continue;
        }
        let Datum::Group(figures) = value else {
            let rows = value.list();
            out += &folded(&name_of(key), rows.len() <= OPEN_ROWS, &list(rows));
            continue;
        };
        let alike = nested
            .iter()
            .filter(|(_, other)| keys(other) == keys(value));
        let alike: Vec<(&str, &Datum)> = alike.copied().collect();
        if alike.len() == 1 {
            out += &folded(&name_of(key), is_named(key), &top(figures));
            continue;
        }
        done.extend(alike.iter().map(|(key, _)| *key));
        let names: Vec<String> = alike.iter().map(|(key, _)| name_of(key)).collect();
        out += &folded(&names.join(", "), true, &side_by_side(&names, &alike));
    }
    out
}

/// Records, and the tables within them, folded.
fn list(rows: &[Datum]) -> String {
    let inner = within(rows).into_iter();
    let inner = inner.map(|(key, rows)| folded(&name_of(key), false, &list(&rows)));
    records(rows) + &inner.collect::<String>()
}

/// Content under a name that opens and closes it.
fn folded(name: &str, is_open: bool, inner: &str) -> String {
    fold_with(if is_open { " open" } else { "" }, &capital(name), inner)
}

/// Words with a capital letter at their head.
pub fn capital(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// Data as rows of name and value with its unit; nothing without data.
fn pairs(figures: &[Entry]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let row = |figure: &Entry| {
        // Both ends of a section in one unit.
        let end = figure.key.replacen("from", "to", 1);
        let ends = figures.iter().filter(|other| other.key == end);
        let length = ends.map(Entry::largest).fold(figure.largest(), f64::max);
        let scale = Scale::of(&figure.unit(), length);
        let text = if figure.largest() < NOTHING * length {
            format!("0 {}", escape(&scale.unit))
        } else {
            figure.in_unit(&scale)
        };
        (false, [escape(&figure.name), text])
    };
    table(&[], figures.iter().map(row))
}

/// Groups of the same figures, a column each.
fn side_by_side(heads: &[String], group: &[(&str, &Datum)]) -> String {
    let columns = group.iter().filter_map(|(_, value)| value.group());
    let columns: Vec<Vec<Entry>> = columns.map(entries).collect();
    let row = |name: &String| {
        let cells = columns.iter().map(|column| {
            let entry = column.iter().find(|entry| entry.name == *name);
            entry.map_or(String::new(), Entry::shown)
        });
        (
            false,
            std::iter::once(escape(name))
                .chain(cells)
                .collect::<Vec<_>>(),
        )
    };
    let heads = std::iter::once("").chain(heads.iter().map(String::as_str));
    let heads: Vec<(&str, bool)> = heads.map(|head| (head, false)).collect();
    let names = distinct(columns.iter().flatten().map(|entry| &entry.name));
    table(&heads, names.into_iter().map(row))
}

/// A case with the keys that its file has.
fn as_stated(case: &Datum) -> String {
    let mut rows = Vec::new();
    stated(&mut rows, "", case);
    table(&[], rows)
}

fn stated(rows: &mut Vec<(bool, [String; 2])>, path: &str, value: &Datum) {
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
        // As someone would have typed it.
        single => {
            let text = match single.number() {
                Some(x) if x.abs() >= 1e6 => format!("{x:e}"),
                Some(x) => x.to_string(),
                None => escape(&single.to_string()),
            };
            rows.push((false, [escape(path), text]));
        }
    }
}
