//! Parts of the page that all sections use.

use std::fmt::Write as _;

use crate::report::page::escape;

/// Widths of a picture on a page and on a phone, whose letters stay as large.
pub const WIDTHS: [f64; 2] = [640.0, 400.0];

/// A picture drawn for a page and for a phone: the page shows the one that fits.
pub fn for_both([page, phone]: [f64; 2], drawn: impl Fn(f64) -> String) -> String {
    format!(
        "<div class=\"page\">{}</div><div class=\"phone\">{}</div>\n",
        drawn(page),
        drawn(phone)
    )
}

/// What a parameter is, where its name does not say so.
pub fn meaning(effect: &str, parameter: &str) -> Option<&'static str> {
    match (effect, parameter) {
        ("wall-contact", "lever_m") => Some(
            "the lever of the wall's force about the centre of gravity: how far ahead of it the wall pushes, behind it where negative",
        ),
        ("runner-compliance", "factor") => Some(
            "how much the runner yields for what the ice yields; a block of steel has about 0.04",
        ),
        _ => None,
    }
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
