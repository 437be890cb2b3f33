//! The catalogue as a page: tables for `docs/effects.md`.

use std::fmt::Write as _;

use crate::known::Info;

/// A Markdown table of effects: name, formula, parameters, level, signature, what looks alike, source.
///
/// ```
/// let page = kufe_effect::page::table(kufe_effect::CATALOGUE.iter().map(|e| e.info()));
/// assert!(page.contains("| `speed-grip` | F_y (1 + k (v - v_ref)) | `slope_s_per_m` [s/m]"));
/// ```
pub fn table(effects: impl Iterator<Item = &'static Info>) -> String {
    let mut page = String::from(
        "| name | formula | parameter [unit] | level | signature | looks like | source |\n|---|---|---|---|---|---|---|\n",
    );
    for info in effects {
        let amplitudes = info.parameters.iter().filter(|p| p.is_amplitude());
        let parameters: Vec<String> = amplitudes
            .map(|p| match p.unit {
                "" => format!("`{}`", p.name),
                unit => format!("`{}` [{unit}]", p.name),
            })
            .collect();
        let _ = writeln!(
            page,
            "| `{}` | {} | {} | {} | {} | {} | {} |",
            info.name,
            cell(info.formula),
            parameters.join(", "),
            info.level().name(),
            cell(info.signature),
            info.looks_like.join(", "),
            cell(info.source),
        );
    }
    page
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The page with what stands between the marks `<!-- NAME -->` and `<!-- end of NAME -->` replaced by `text`.
///
/// `None` where the page lacks a mark.
pub fn with_section(page: &str, name: &str, text: &str) -> Option<String> {
    let (from, to) = (
        format!("<!-- {name} -->\n"),
        format!("<!-- end of {name} -->"),
    );
    let begin = page.find(&from)? + from.len();
    let end = begin + page[begin..].find(&to)?;
    Some(format!("{}{text}{}", &page[..begin], &page[end..]))
}
