//! The catalogue as a page: tables for `docs/effects.md`.

use std::fmt::Write as _;

use crate::effects::{ActsOn, Info};

/// Headings of the page by what effects act on first.
const GROUPS: [(ActsOn, &str); 8] = [
    (ActsOn::Friction, "Friction coefficient"),
    (ActsOn::Along, "Forces along the sled"),
    (ActsOn::Across, "Side forces"),
    (ActsOn::Sensor, "Sensors of the sled"),
    (ActsOn::Sled, "Constants of the sled"),
    (ActsOn::Track, "The track"),
    (ActsOn::Contact, "The contact"),
    (ActsOn::Map, "The pressure sensor"),
];

/// Markdown tables of effects under a heading for what they act on: name, formula, parameters, signature, what looks alike.
/// Sources stay in the effects' files.
///
/// ```
/// use kufe_sled::effects::{CATALOGUE, page};
/// let page = page::tables(CATALOGUE.iter().map(|effect| &effect.info));
/// assert!(page.contains("| `speed-grip` | F_y (1 + k (v - v_ref)) | `slope_s_per_m` [s/m]"));
/// ```
pub fn tables(effects: impl Iterator<Item = &'static Info>) -> String {
    let rows: Vec<&Info> = effects.collect();
    let mut page = String::new();
    for (on, heading) in GROUPS {
        let mut own = rows.iter().filter(|info| info.acts_on.first() == Some(&on));
        let Some(first) = own.next() else {
            continue;
        };
        let _ = write!(
            page,
            "\n### {heading}\n\n| name | formula | parameter [unit] | signature | looks like |\n\
             |---|---|---|---|---|\n"
        );
        for row in std::iter::once(first).chain(own) {
            page.push_str(&line(row));
        }
    }
    page.push('\n');
    page
}

fn line(info: &Info) -> String {
    let amplitudes = info.parameters.iter().filter(|p| p.is_amplitude());
    let parameters: Vec<String> = amplitudes
        .map(|p| match p.unit {
            "" => format!("`{}`", p.name),
            unit => format!("`{}` [{unit}]", p.name),
        })
        .collect();
    let cells = [
        format!("`{}`", info.name),
        info.formula.to_owned(),
        parameters.join(", "),
        info.signature.to_owned(),
        info.looks_like.join(", "),
    ];
    let cells = cells.map(|text| text.replace('|', "\\|"));
    format!("| {} |\n", cells.join(" | "))
}

/// The page with what stands between the marks `<!-- NAME -->` and `<!-- end of NAME -->` replaced by `text`.
///
/// `None` where the page lacks a mark.
///
/// ```
/// let page = "a\n<!-- x -->\nold\n<!-- end of x -->\nb";
/// let new = kufe_sled::effects::page::with_section(page, "x", "new\n").unwrap();
/// assert_eq!(new, "a\n<!-- x -->\nnew\n<!-- end of x -->\nb");
/// ```
pub fn with_section(page: &str, name: &str, text: &str) -> Option<String> {
    let (from, to) = (
        format!("<!-- {name} -->\n"),
        format!("<!-- end of {name} -->"),
    );
    let begin = page.find(&from)? + from.len();
    let end = begin + page[begin..].find(&to)?;
    Some(format!("{}{text}{}", &page[..begin], &page[end..]))
}
