//! Formatting of values and tables for all sections of the page.

use crate::plot::{Scale, escape, quantity, unit_of};
use crate::report::html::{self, fold};
use crate::results::finding::{Bin, Fitted};

/// Values in the display unit of the largest of them, and this unit.
pub fn alike<const N: usize>(values: [f64; N], unit: &str) -> ([String; N], Scale) {
    let scale = Scale::of_all(unit, values);
    (values.map(|value| scale.number(value)), scale)
}

/// A bin as `column from to unit`; the column may name a track, as `s_m on east`.
pub fn range(bin: &Bin) -> String {
    let column = bin.column.split(' ').next().unwrap_or_default();
    let ([from, to], scale) = alike([bin.from, bin.to], &unit_of(column));
    format!(
        "{} {}",
        bin.column,
        scale.with_unit(&format!("{from} to {to}"))
    )
}

/// `name = value unit (95 % interval low to high)`.
pub fn size(parameter: &Fitted) -> String {
    let unit = &parameter.unit;
    let ([value, low, high], scale) = alike([parameter.value, parameter.low, parameter.high], unit);
    let text = format!(
        "{} = {} (95 % interval {low} to {high})",
        parameter.name,
        scale.with_unit(&value)
    );
    if unit != "1/Pa" {
        return text;
    }
    // Readers know the hardness of ice, not its inverse.
    let inverse = quantity(1.0 / parameter.value, "Pa");
    format!("{text}, the inverse of {inverse}")
}

/// Explanation of a parameter whose name is not self-explanatory.
pub fn meaning(effect: &str, parameter: &str) -> Option<&'static str> {
    match (effect, parameter) {
        ("wall-contact", "lever_m") => {
            Some("distance of the wall's force ahead of the centre of gravity")
        }
        ("runner-compliance", "factor") => Some(
            "compliance of the runner relative to that of the ice; a block of steel has about 0.04",
        ),
        _ => None,
    }
}

/// A fold with content; empty without content.
pub fn folded(title: &str, inner: String) -> String {
    match &*inner {
        "" => inner,
        inner => fold(title, inner),
    }
}

/// A folded list of texts; empty without items.
pub fn list(title: &str, items: impl Iterator<Item = String>) -> String {
    let items: String = items
        .map(|text| format!("<li>{}</li>\n", escape(&text)))
        .collect();
    match &*items {
        "" => items,
        items => fold(title, &format!("<ul>\n{items}</ul>\n")),
    }
}

/// A table of texts with the columns `NAME|#NAME|..`, where `#` marks numbers; empty without rows.
pub fn table<const N: usize>(names: &str, rows: impl IntoIterator<Item = [String; N]>) -> String {
    headed_table("", names, rows.into_iter().map(|cells| (false, cells)))
}

/// As [`table`], with HTML above it, and rows that are shaded where their flag is set.
pub fn headed_table<const N: usize>(
    head: &str,
    names: &str,
    rows: impl IntoIterator<Item = (bool, [String; N])>,
) -> String {
    let rows = rows.into_iter();
    let rows = rows.map(|(shaded, cells)| (shaded, cells.map(|text| escape(&text))));
    let mut rows = rows.peekable();
    match rows.peek() {
        Some(_) => head.to_owned() + &html::shaded_table(&html::columns(names), rows),
        None => String::new(),
    }
}

/// A p-value as `= 0.012` or `< 1e-6`.
pub fn p_is(p: f64) -> String {
    let sign = if p < MIN_P { "" } else { "= " };
    format!("{sign}{}", p_value(p))
}

/// Smallest p-value that is stated: smaller tails are not known more accurately.
const MIN_P: f64 = 1e-6;

/// A p-value.
pub fn p_value(p: f64) -> String {
    match p {
        ..MIN_P => "< 1e-6".to_owned(),
        ..1e-3 => format!("{p:.0e}"),
        _ => format!("{p:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_have_the_units_of_their_columns_on_a_track_too() {
        for (column, expected) in [
            ("s_m on east", "s_m on east 10 to 20 m"),
            ("ax_mps2", "ax_mps2 10 to 20 m/s²"),
            ("humidity", "humidity 10 to 20"),
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
    fn cells_of_a_table_are_text() {
        let out = headed_table("", "name|#p", [(true, ["<a>".to_owned(), p_value(1e-9)])]);
        let row = "<tr class=in><td>&lt;a&gt;<td class=n>&lt; 1e-6\n";
        assert!(out.contains(row), "{out}");
    }
}
