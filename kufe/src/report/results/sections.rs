//! A document as tables: what matters most first and open, the rest folded.

use std::fmt::Write as _;

use crate::report::page::escape;
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
pub fn document(out: &mut String, document: &Datum) {
    match document {
        Datum::Group(figures) => top(out, figures),
        Datum::List(rows) => list(out, rows),
        single => {
            let _ = writeln!(out, "<p>{}</p>", escape(&single.to_string()));
        }
    }
}

/// The figures of a group, then its parts, then the further figures.
fn top(out: &mut String, figures: &Data) {
    let shown = figures.iter().filter(|(key, value)| {
        !ASIDE.contains(key) && !CASES.contains(key) && **value != Datum::Absent(())
    });
    let (nested, single): (Vec<_>, Vec<_>) =
        shown.partition(|(_, value)| value.is_table() || has_parts(value));
    let single = single.into_iter();
    let single = single.map(|(key, value)| (key.to_owned(), value.clone()));
    let single = Data(single.collect());
    let (first, further): (Vec<Entry>, Vec<Entry>) = entries(&single)
        .into_iter()
        .partition(|entry| is_named(entry.key));
    pairs(out, &first);
    let alone = first.is_empty() && nested.is_empty();
    parts(out, nested);
    let none = single.iter().filter(|(_, value)| value.is_empty());
    let none: Vec<&str> = none.map(|(key, _)| key).collect();
    if !further.is_empty() || !none.is_empty() {
        let mut inner = String::new();
        pairs(&mut inner, &further);
        if !none.is_empty() {
            let none: Vec<String> = none
                .iter()
                .map(|key| format!("{}: none", escape(&name_of(key))))
                .collect();
            let _ = writeln!(inner, "<p>{}</p>", none.join("; "));
        }
        if alone || further.len() <= FEW {
            out.push_str(&inner);
        } else {
            folded(out, "further figures", false, &inner);
        }
    }
    for (key, value) in figures.iter().filter(|(key, _)| CASES.contains(key)) {
        let cases = match value {
            Datum::List(cases) => cases,
            case => std::slice::from_ref(case),
        };
        let mut inner = String::new();
        for case in cases {
            as_stated(&mut inner, case);
        }
        folded(out, &format!("{key}, as stated"), false, &inner);
    }
}

/// Whether a figure is a group of more than a value with its interval.
fn has_parts(figure: &Datum) -> bool {
    let group = figure.group().filter(|_| !figure.is_empty());
    group.is_some_and(|figures| figures.get("value").is_none())
}

/// Groups and tables under their names, long ones last; groups of the same keys side by side.
fn parts(out: &mut String, mut nested: Vec<(&str, &Datum)>) {
    nested.sort_by_key(|(_, value)| value.list().len() > OPEN_ROWS);
    let mut done: Vec<&str> = Vec::new();
    for (key, value) in &nested {
        if done.contains(key) {
            continue;
        }
        let mut inner = String::new();
        let Datum::Group(figures) = value else {
            let rows = value.list();
            list(&mut inner, rows);
            folded(out, &name_of(key), rows.len() <= OPEN_ROWS, &inner);
            continue;
        };
        let keys = |figures: &Data| -> Vec<String> {
            figures.0.iter().map(|(key, _)| key.clone()).collect()
        };
        let alike = |other: &Datum| {
            let other = other.group();
            other.is_some_and(|other| keys(other) == keys(figures))
        };
        let group = nested.iter().filter(|(_, other)| alike(other));
        let group: Vec<(&str, &Datum)> = group.copied().collect();
        if group.len() > 1 {
            side_by_side(&mut inner, &group);
            let names: Vec<String> = group.iter().map(|(key, _)| name_of(key)).collect();
            folded(out, &names.join(", "), true, &inner);
            done.extend(group.iter().map(|(key, _)| *key));
        } else {
            top(&mut inner, figures);
            folded(out, &name_of(key), is_named(key), &inner);
        }
    }
}

/// Records, and the tables within them, folded.
fn list(out: &mut String, rows: &[Datum]) {
    records(out, rows);
    for (key, rows) in within(rows) {
        let mut inner = String::new();
        list(&mut inner, &rows);
        folded(out, &name_of(key), false, &inner);
    }
}

/// Content under a name that opens and closes it.
fn folded(out: &mut String, name: &str, open: bool, inner: &str) {
    let open = if open { " open" } else { "" };
    let _ = writeln!(
        out,
        "<details{open}><summary>{}</summary>\n{inner}</details>",
        escape(&capital(name))
    );
}

/// Words with a capital letter at their head.
pub fn capital(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// Data as rows of name and value with its unit.
fn pairs(out: &mut String, figures: &[Entry]) {
    if figures.is_empty() {
        return;
    }
    out.push_str("<div class=\"wide\"><table>\n");
    for figure in figures {
        // Both ends of a section in one unit.
        let end = figure.key.replacen("from", "to", 1);
        let ends = figures
            .iter()
            .filter(|other| other.key == end)
            .map(Entry::largest);
        let length = ends.fold(figure.largest(), f64::max);
        let scale = Scale::of(figure.unit(), length);
        let text = if figure.largest() < NOTHING * length {
            format!("0 {}", escape(&scale.unit))
        } else {
            figure.in_unit(&scale)
        };
        let _ = writeln!(out, "<tr><td>{}<td>{text}", escape(&figure.name));
    }
    out.push_str("</table></div>\n");
}

/// Groups of the same figures, a column each.
fn side_by_side(out: &mut String, group: &[(&str, &Datum)]) {
    out.push_str("<div class=\"wide\"><table><tr><th>");
    for (key, _) in group {
        let _ = write!(out, "<th>{}", escape(&name_of(key)));
    }
    out.push('\n');
    let columns: Vec<Vec<Entry>> = group
        .iter()
        .filter_map(|(_, value)| value.group())
        .map(entries)
        .collect();
    let mut names: Vec<&str> = Vec::new();
    for entry in columns.iter().flatten() {
        if !names.contains(&entry.name.as_str()) {
            names.push(&entry.name);
        }
    }
    for name in &names {
        let _ = write!(out, "<tr><td>{}", escape(name));
        for column in &columns {
            let entry = column.iter().find(|entry| entry.name == *name);
            let text = entry.map_or(String::new(), |entry| {
                entry.in_unit(&Scale::of(entry.unit(), entry.largest()))
            });
            let _ = write!(out, "<td>{text}");
        }
        out.push('\n');
    }
    out.push_str("</table></div>\n");
}

/// A case with the keys that its file has.
fn as_stated(out: &mut String, case: &Datum) {
    out.push_str("<div class=\"wide\"><table>\n");
    stated(out, "", case);
    out.push_str("</table></div>\n");
}

fn stated(out: &mut String, path: &str, value: &Datum) {
    let text = match value {
        Datum::Group(figures) => {
            let dot = if path.is_empty() { "" } else { "." };
            let figures = figures.iter();
            return figures
                .for_each(|(key, value)| stated(out, &format!("{path}{dot}{key}"), value));
        }
        Datum::List(values) if value.is_table() => {
            let places = values.iter().enumerate();
            return places.for_each(|(k, value)| stated(out, &format!("{path}[{k}]"), value));
        }
        // As someone would have typed it.
        other => match other.number() {
            Some(x) if x.abs() >= 1e6 => format!("{x:e}"),
            Some(x) => x.to_string(),
            None => escape(&other.to_string()),
        },
    };
    let _ = writeln!(out, "<tr><td>{}<td>{text}", escape(path));
}
