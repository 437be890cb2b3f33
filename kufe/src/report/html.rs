//! HTML elements of pages.

use crate::plot::{Figure, escape};

/// Width of a picture on a phone [pixels].
const PHONE: f64 = 400.0;

/// A picture in two widths, for wide pages and for phones; the page shows the one that fits.
pub fn for_both(page: f64, figure: Figure) -> String {
    let svg = |width| {
        Figure {
            width,
            ..figure.clone()
        }
        .svg()
    };
    let (page, phone) = (svg(page), svg(PHONE));
    format!("<div class=\"page\">{page}</div><div class=\"phone\">{phone}</div>\n")
}

/// A paragraph in small print.
pub fn small(text: &str) -> String {
    format!("<p><small>{}</small></p>\n", escape(text))
}

/// A section that opens when it is clicked; `inner` is HTML.
pub fn fold(title: &str, inner: &str) -> String {
    fold_with("", title, inner)
}

/// As [`fold`], with attributes of the element.
pub fn fold_with(attributes: &str, title: &str, inner: &str) -> String {
    let title = escape(title);
    format!("<details{attributes}><summary>{title}</summary>\n{inner}</details>\n")
}

/// Figures side by side, each with its description.
pub fn tiles<T: AsRef<str>>(figures: impl IntoIterator<Item = (T, T)>) -> String {
    let tile = |(figure, what): (T, T)| {
        let [figure, what] = [figure, what].map(|text| escape(text.as_ref()));
        format!("<div><b>{figure}</b><span>{what}</span></div>\n")
    };
    let tiles: String = figures.into_iter().map(tile).collect();
    format!("<div class=\"tiles\">\n{tiles}</div>\n")
}

/// Columns of a table from `NAME|#NAME|..`: each name, and whether a `#` marks a column of numbers.
pub fn columns(names: &str) -> Vec<(&str, bool)> {
    let names = names.split('|');
    names
        .map(|name| (name.trim_start_matches('#'), name.starts_with('#')))
        .collect()
}

/// A table of HTML cells; without `columns` it has no header.
pub fn table(
    columns: &[(&str, bool)],
    rows: impl IntoIterator<Item = impl AsRef<[String]>>,
) -> String {
    shaded_table(columns, rows.into_iter().map(|cells| (false, cells)))
}

/// As [`table`], with rows that are shaded where their flag is set.
pub fn shaded_table(
    columns: &[(&str, bool)],
    rows: impl IntoIterator<Item = (bool, impl AsRef<[String]>)>,
) -> String {
    let class = |k: usize| match columns.get(k) {
        Some((_, true)) => " class=n",
        _ => "",
    };
    let heads = columns.iter().enumerate();
    let heads = heads.map(|(k, (name, _))| format!("<th{}>{}", class(k), escape(name)));
    let row = if columns.is_empty() { "" } else { "<tr>" };
    let mut out = format!(
        "<div class=\"wide\"><table>{row}{}",
        heads.collect::<String>()
    );
    for (is_shaded, cells) in rows {
        out += if is_shaded {
            "\n<tr class=in>"
        } else {
            "\n<tr>"
        };
        let cells = cells.as_ref().iter().enumerate();
        out.extend(cells.map(|(k, cell)| format!("<td{}>{cell}", class(k))));
    }
    out + "\n</table></div>\n"
}

/// A page of text, tables and pictures without scripts; `body` is HTML.
///
/// Its content security policy permits only its own styles and pictures.
pub fn plain_page(title: &str, body: &str) -> String {
    const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; \
        base-uri 'none'; form-action 'none'";
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    const PLAIN: &str = include_str!("../../assets/plain.css");
    const PICTURE: &str = include_str!("../../assets/picture.css");
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"generator\" content=\"kufe {VERSION}\"><title>{title}</title>\
         <style>{PLAIN}{PICTURE}</style></head><body>\n{body}</body></html>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_table_are_aligned_and_names_are_text() {
        let row = (true, ["a".to_owned(), "1".to_owned()]);
        let html = shaded_table(&columns("<name>|#p"), [row]);
        assert!(
            html.contains("<tr><th>&lt;name&gt;<th class=n>p\n"),
            "{html}"
        );
        assert!(html.contains("<tr class=in><td>a<td class=n>1\n"), "{html}");
        let html = table(&[], [["a".to_owned()]]);
        assert_eq!(
            html,
            "<div class=\"wide\"><table>\n<tr><td>a\n</table></div>\n"
        );
    }
}
