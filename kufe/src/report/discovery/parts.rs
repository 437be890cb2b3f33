//! Parts of the page that all sections use.

use std::fmt::Write as _;

use crate::plot::{escape, number4, unit_of, usual};
use crate::report::sign::sign;
use crate::results::finding::{Bin, Fitted};

/// The unit in which values are shown.
pub fn unit_text(unit: &str) -> String {
    sign(usual(1.0, unit).1)
}

/// A value without its unit.
pub fn shown(value: f64, unit: &str) -> String {
    number4(usual(value, unit).0)
}

/// A value with its unit.
pub fn amount(value: f64, unit: &str) -> String {
    let text = format!("{} {}", shown(value, unit), unit_text(unit));
    text.trim_end().to_owned()
}

/// `channel [unit]`.
pub fn channel_label(channel: &str, unit: &str) -> String {
    match &*unit_text(unit) {
        "" => channel.to_owned(),
        unit => format!("{channel} [{unit}]"),
    }
}

/// `column from to unit`; a place is one on a track, as `s_m on east`.
pub fn range(bin: &Bin) -> String {
    let column = bin.column.split(' ').next().unwrap_or_default();
    let unit = unit_of(column);
    let (from, to) = (shown(bin.from, &unit), shown(bin.to, &unit));
    let text = format!("{} {from} to {to} {}", bin.column, unit_text(&unit));
    text.trim_end().to_owned()
}

/// `name = value unit (95 % interval low to high)`.
pub fn size(parameter: &Fitted) -> String {
    let unit = &parameter.unit;
    let value = amount(parameter.value, unit);
    let (low, high) = (shown(parameter.low, unit), shown(parameter.high, unit));
    let text = format!(
        "{} = {value} (95 % interval {low} to {high})",
        parameter.name
    );
    match &**unit {
        // The hardness of ice is known, its inverse is not.
        "1/Pa" => format!(
            "{text}, the inverse of {}",
            amount(1.0 / parameter.value, "Pa")
        ),
        _ => text,
    }
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

/// A table of the columns `NAME|NAME|..`, of which those with a `#` are numbers; rows are shaded
/// where their flag is set.
pub fn table<const N: usize>(
    out: &mut String,
    columns: &str,
    rows: impl IntoIterator<Item = (bool, [String; N])>,
) {
    let columns: Vec<&str> = columns.split('|').collect();
    let class = |k: usize| {
        if columns[k].starts_with('#') {
            " class=n"
        } else {
            ""
        }
    };
    out.push_str("<div class=\"wide\"><table><tr>");
    for (k, column) in columns.iter().enumerate() {
        let column = escape(column.trim_start_matches('#'));
        let _ = write!(out, "<th{}>{column}", class(k));
    }
    out.push_str("</tr>\n");
    for (shaded, cells) in rows {
        out.push_str(if shaded { "<tr class=in>" } else { "<tr>" });
        for (k, cell) in cells.iter().enumerate() {
            let _ = write!(out, "<td{}>{}", class(k), escape(cell));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
}

/// A p-value as `= 0.012` or `< 1e-6`.
pub fn p_is(p: f64) -> String {
    match p_value(p) {
        text if text.starts_with('<') => text,
        text => format!("= {text}"),
    }
}

/// A p-value; tails below a millionth are not known any better.
pub fn p_value(p: f64) -> String {
    if p < 1e-6 {
        "< 1e-6".to_owned()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_have_the_units_of_their_columns_on_a_track_too() {
        for (column, expected) in [
            ("s_m on east", "s_m on east 10.00 to 20.00 m"),
            ("ax_mps2", "ax_mps2 10.00 to 20.00 m/s²"),
            ("humidity", "humidity 10.00 to 20.00"),
        ] {
            let bin = Bin {
                column: column.to_owned(),
                from: 10.0,
                to: 20.0,
                ..Bin::default()
            };
            assert_eq!(range(&bin), expected);
        }
    }

    #[test]
    fn cells_of_a_table_are_text_and_numbers_are_aligned() {
        let mut out = String::new();
        table(
            &mut out,
            "name|#p",
            [(true, ["<a>".to_owned(), p_value(1e-9)])],
        );
        assert!(out.contains("<th>name<th class=n>p</tr>"), "{out}");
        let row = "<tr class=in><td>&lt;a&gt;<td class=n>&lt; 1e-6</tr>";
        assert!(out.contains(row), "{out}");
    }
}
