//! A page of what any command has written: its pictures, then its figures as tables.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use kufe_plot::number4;
use serde_json::{Map, Value};

use crate::page::{escape, plain_page};

/// Most rows of a table that a page shows.
const MOST_ROWS: usize = 200;
/// Longest table that stands open.
const OPEN_ROWS: usize = 40;
/// Most values of a list that are shown one by one.
const MOST_VALUES: usize = 8;

/// A PNG file as the address of a picture that stands in the page itself.
pub fn picture_url(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// The page: `pictures` are names and PNG files, `documents` names and JSON.
pub fn results_page(
    title: &str,
    pictures: &[(String, Vec<u8>)],
    documents: &[(String, Value)],
) -> String {
    let mut out = format!("<h1>{}</h1>\n", escape(title));
    for (name, png) in pictures {
        let _ = writeln!(
            out,
            "<div class=\"wide\"><img alt=\"{}\" src=\"{}\"></div>",
            escape(name),
            picture_url(png)
        );
    }
    for (name, document) in documents {
        let _ = writeln!(out, "<h2>{}</h2>", escape(name));
        match document {
            Value::Object(fields) => object(&mut out, fields),
            Value::Array(rows) => list(&mut out, rows),
            single => {
                let _ = writeln!(out, "<p>{}</p>", cell(single));
            }
        }
    }
    plain_page(title, &out)
}

/// What is single in a table of its own, what is nested after it, folded.
fn object(out: &mut String, fields: &Map<String, Value>) {
    let nested = |value: &Value| value.is_object() || is_table(value);
    let (tables, single): (Vec<_>, Vec<_>) = fields.iter().partition(|(_, value)| nested(value));
    if !single.is_empty() {
        out.push_str("<div class=\"wide\"><table>\n");
        for (key, value) in single {
            let _ = writeln!(out, "<tr><td>{}<td>{}", escape(key), cell(value));
        }
        out.push_str("</table></div>\n");
    }
    for (key, value) in tables {
        folded(out, key, value);
    }
}

/// What is nested under its name, open where it is short.
fn folded(out: &mut String, name: &str, value: &Value) {
    let length = value.as_array().map(Vec::len);
    let length = length.or(value.as_object().map(Map::len)).unwrap_or(0);
    let open = if length <= OPEN_ROWS { " open" } else { "" };
    let _ = writeln!(out, "<details{open}><summary>{}</summary>", escape(name));
    match value {
        Value::Object(fields) => object(out, fields),
        Value::Array(rows) => list(out, rows),
        _ => {}
    }
    out.push_str("</details>\n");
}

/// Whether a value is rows of a table.
fn is_table(value: &Value) -> bool {
    let rows = value.as_array();
    rows.is_some_and(|rows| rows.iter().any(Value::is_object))
}

/// Objects as rows of one table, whose columns are all their keys; tables within a row follow, under its first word.
fn list(out: &mut String, rows: &[Value]) {
    let mut columns: Vec<&String> = Vec::new();
    for key in rows.iter().filter_map(Value::as_object).flat_map(Map::keys) {
        if !columns.contains(&key) {
            columns.push(key);
        }
    }
    let in_rows = |column: &&String| rows.iter().any(|row| is_table(&row[column.as_str()]));
    let (within, columns): (Vec<&String>, Vec<&String>) = columns.into_iter().partition(in_rows);
    out.push_str("<div class=\"wide\"><table><tr>");
    for column in &columns {
        let _ = write!(out, "<th>{}", escape(column));
    }
    out.push('\n');
    for row in rows.iter().take(MOST_ROWS) {
        out.push_str("<tr>");
        for column in &columns {
            let value = &row[column.as_str()];
            let _ = write!(out, "<td{}>{}", class(value), cell(value));
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
    for row in rows.iter().take(MOST_ROWS) {
        let words = row.as_object().into_iter().flatten();
        let first = words.filter_map(|(_, value)| value.as_str()).next();
        for column in within
            .iter()
            .filter(|column| is_table(&row[column.as_str()]))
        {
            let name = first.map_or((*column).clone(), |first| format!("{first}: {column}"));
            folded(out, &name, &row[column.as_str()]);
        }
    }
}

fn class(value: &Value) -> &'static str {
    match value.is_number() {
        true => " class=n",
        false => "",
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::Bool(truth) => if *truth { "yes" } else { "no" }.to_owned(),
        Value::Number(number) => match number.as_f64() {
            // Counts and years as they are.
            Some(x) if x.fract() == 0.0 && x.abs() < 1e7 => format!("{x:.0}"),
            Some(x) => number4(x),
            None => number.to_string(),
        },
        Value::String(text) => escape(text),
        Value::Array(values) if values.is_empty() => "none".to_owned(),
        Value::Array(values) if values.len() > MOST_VALUES => format!("{} values", values.len()),
        Value::Array(values) => values.iter().map(cell).collect::<Vec<_>>().join(", "),
        Value::Object(fields) => fields
            .iter()
            .map(|(key, value)| format!("{} {}", escape(key), cell(value)))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn rows_that_differ_share_a_table_and_nothing_becomes_markup() {
        let document = json!({
            "mu": 0.00412345, "runs": 12, "left_out": [], "of": { "driver": "<A>" },
            "points": [{ "v_mps": 5.0, "mu": 4.1e-3 }, { "v_mps": 10.0, "note": "x & y" }],
            "tracks": [{ "track": "east", "runs": [{ "run": "A1" }] }],
        });
        let page = results_page("a <b>", &[], &[("friction.json".into(), document)]);
        assert!(page.contains("<title>a &lt;b&gt;</title>"));
        assert!(page.contains("<tr><th>v_mps<th>mu<th>note\n"));
        assert!(page.contains("<tr><td class=n>5<td class=n>0.004100<td>\n"));
        assert!(page.contains("<tr><td class=n>10<td><td>x &amp; y\n"));
        assert!(page.contains("<summary>east: runs</summary>") && page.contains("<tr><td>A1\n"));
        assert!(
            page.contains("<td>runs<td>12\n<tr><td>left_out<td>none\n")
                && page.contains("<td>driver<td>&lt;A&gt;")
        );
    }
}
