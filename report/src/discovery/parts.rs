//! Parts of the page that all sections use.

use std::fmt::Write as _;

use crate::page::escape;

/// What may be wider than a narrow screen scrolls by itself.
pub fn wide(out: &mut String, what: &str) {
    let _ = writeln!(out, "<div class=\"wide\">{what}</div>");
}

/// A section that opens when it is clicked.
pub fn fold(out: &mut String, title: &str, fill: impl FnOnce(&mut String)) {
    let _ = writeln!(out, "<details><summary>{}</summary>", escape(title));
    fill(out);
    out.push_str("</details>\n");
}

/// A folded list; nothing where it is empty.
pub fn list(out: &mut String, title: &str, items: impl Iterator<Item = String>) {
    let items: Vec<String> = items
        .map(|text| format!("<li>{}</li>\n", escape(&text)))
        .collect();
    if !items.is_empty() {
        fold(out, title, |out| {
            let _ = write!(out, "<ul>\n{}</ul>\n", items.concat());
        });
    }
}

/// A p-value as `= 0.012` or `&lt; 1e-6`.
pub fn p_is(p: f64) -> String {
    match p_value(p) {
        text if text.starts_with('&') => text,
        text => format!("= {text}"),
    }
}

/// A p-value; tails below a millionth are not known any better.
pub fn p_value(p: f64) -> String {
    if p < 1e-6 {
        "&lt; 1e-6".to_owned()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}
