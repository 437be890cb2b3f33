//! A document as tables: what says most first and open, the rest folded.

use std::fmt::Write as _;

use serde_json::{Map, Value};

use crate::report::page::escape;
use crate::report::results::amount::Scale;
use crate::report::results::entry::{Entry, entries, is_empty, is_table};
use crate::report::results::label::{is_named, name_of};
use crate::report::results::records::{records, within};

/// Longest table that stands open.
const OPEN_ROWS: usize = 40;
/// So many figures that say less need no fold.
const FEW: usize = 2;
/// An end of a stretch that is less of its length than this is its beginning.
const NOTHING: f64 = 1e-5;

/// What a page says elsewhere, or what is about files rather than about what they hold.
const ASIDE: [&str; 3] = ["version", "files", "content_sha256"];
/// Cases stand as their file has them.
const CASES: [&str; 2] = ["case", "cases"];

/// A document's tables.
pub fn document(out: &mut String, document: &Value) {
    match document {
        Value::Object(fields) => top(out, fields),
        Value::Array(rows) => list(out, rows),
        single => {
            let _ = writeln!(out, "<p>{}</p>", escape(&single.to_string()));
        }
    }
}

/// An object's figures, then what it holds, then what says less.
fn top(out: &mut String, fields: &Map<String, Value>) {
    let retained = |(key, value): &(&String, &Value)| {
        !ASIDE.contains(&key.as_str()) && !CASES.contains(&key.as_str()) && !value.is_null()
    };
    let (nested, single): (Vec<_>, Vec<_>) = fields
        .iter()
        .filter(retained)
        .map(|(key, value)| (key.as_str(), value))
        .partition(|(_, value)| is_table(value) || has_parts(value));
    let single: Map<String, Value> = single
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value.clone()))
        .collect();
    let (first, further): (Vec<Entry>, Vec<Entry>) = entries(&single)
        .into_iter()
        .partition(|entry| is_named(entry.key));
    pairs(out, &first);
    let alone = first.is_empty() && nested.is_empty();
    parts(out, nested);
    let none: Vec<&String> = single
        .iter()
        .filter(|(_, value)| is_empty(value))
        .map(|(key, _)| key)
        .collect();
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
        match alone || further.len() <= FEW {
            true => out.push_str(&inner),
            false => folded(out, "further figures", false, &inner),
        }
    }
    for (key, value) in CASES.iter().filter_map(|key| fields.get_key_value(*key)) {
        let cases = value
            .as_array()
            .map_or(std::slice::from_ref(value), Vec::as_slice);
        let mut inner = String::new();
        for case in cases {
            as_stated(&mut inner, case);
        }
        folded(out, &format!("{key}, as stated"), false, &inner);
    }
}

/// Whether an object is more than an interval's ends, and says anything.
fn has_parts(value: &Value) -> bool {
    let fields = value.as_object();
    fields.is_some_and(|fields| !fields.is_empty() && !fields.contains_key("value"))
}

/// Objects and tables under their names, long ones last; objects of the same keys side by side.
fn parts(out: &mut String, mut nested: Vec<(&str, &Value)>) {
    let rows = |value: &Value| value.as_array().map_or(0, Vec::len);
    nested.sort_by_key(|(_, value)| rows(value) > OPEN_ROWS);
    let mut done: Vec<&str> = Vec::new();
    for (key, value) in &nested {
        if done.contains(key) {
            continue;
        }
        let mut inner = String::new();
        let Value::Object(fields) = value else {
            list(&mut inner, value.as_array().map_or(&[], Vec::as_slice));
            folded(out, &name_of(key), rows(value) <= OPEN_ROWS, &inner);
            continue;
        };
        let alike = |other: &Value| {
            other
                .as_object()
                .is_some_and(|other| other.keys().eq(fields.keys()))
        };
        let group: Vec<(&str, &Value)> = nested
            .iter()
            .copied()
            .filter(|(_, other)| alike(other))
            .collect();
        if group.len() > 1 {
            side_by_side(&mut inner, &group);
            let names: Vec<String> = group.iter().map(|(key, _)| name_of(key)).collect();
            folded(out, &names.join(", "), true, &inner);
            done.extend(group.iter().map(|(key, _)| *key));
        } else {
            top(&mut inner, fields);
            folded(out, &name_of(key), is_named(key), &inner);
        }
    }
}

/// Records, and the tables within them, folded.
fn list(out: &mut String, rows: &[Value]) {
    records(out, rows);
    for (key, rows) in within(rows) {
        let mut inner = String::new();
        list(&mut inner, &rows);
        folded(out, &name_of(key), false, &inner);
    }
}

/// What stands under a name that opens and closes it.
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

/// Figures as rows of name and value with its unit.
fn pairs(out: &mut String, figures: &[Entry]) {
    if figures.is_empty() {
        return;
    }
    out.push_str("<div class=\"wide\"><table>\n");
    for figure in figures {
        // Both ends of a stretch in one unit.
        let end = figure.key.replacen("from", "to", 1);
        let ends = figures
            .iter()
            .filter(|other| other.key == end)
            .map(Entry::largest);
        let length = ends.fold(figure.largest(), f64::max);
        let scale = Scale::of(figure.unit(), length);
        let text = match figure.largest() < NOTHING * length {
            true => format!("0 {}", escape(&scale.unit)),
            false => figure.in_unit(&scale),
        };
        let _ = writeln!(out, "<tr><td>{}<td>{text}", escape(&figure.name));
    }
    out.push_str("</table></div>\n");
}

/// Objects of the same figures, a column each.
fn side_by_side(out: &mut String, group: &[(&str, &Value)]) {
    out.push_str("<div class=\"wide\"><table><tr><th>");
    for (key, _) in group {
        let _ = write!(out, "<th>{}", escape(&name_of(key)));
    }
    out.push('\n');
    let columns: Vec<Vec<Entry>> = group
        .iter()
        .filter_map(|(_, value)| value.as_object())
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
fn as_stated(out: &mut String, case: &Value) {
    out.push_str("<div class=\"wide\"><table>\n");
    stated(out, "", case);
    out.push_str("</table></div>\n");
}

fn stated(out: &mut String, path: &str, value: &Value) {
    let text = match value {
        Value::Object(fields) => {
            let dot = if path.is_empty() { "" } else { "." };
            return fields
                .iter()
                .for_each(|(key, value)| stated(out, &format!("{path}{dot}{key}"), value));
        }
        Value::Array(values) if is_table(value) => {
            let places = values.iter().enumerate();
            return places.for_each(|(k, value)| stated(out, &format!("{path}[{k}]"), value));
        }
        Value::String(text) => escape(text),
        // As someone would have typed it.
        Value::Number(number) => match number.as_f64() {
            Some(x) if x.abs() >= 1e6 => format!("{x:e}"),
            Some(x) => x.to_string(),
            None => number.to_string(),
        },
        other => escape(&other.to_string()),
    };
    let _ = writeln!(out, "<tr><td>{}<td>{text}", escape(path));
}
