//! The catalogue as a page: tables for `docs/effects.md`.

use std::fmt::Write as _;

use crate::known::{ActsOn, Info, Judged};
use crate::law::Effect;

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

/// One effect on the page: what is known of it, and its example in words.
pub struct Row {
    /// What is known of it.
    pub info: &'static Info,
    /// What it makes of which values.
    pub example: String,
}

impl Row {
    /// An effect of this crate's catalogue.
    pub fn of(effect: &'static Effect) -> Self {
        let known = effect.info.parameters.iter().zip(effect.example.parameters);
        let parameters = known.filter(|(p, value)| **value != p.default);
        let parameters = parameters.map(|(p, value)| format!("{} = {}", p.name, number(*value)));
        let given = effect.example.given.iter();
        let given = given.map(|(name, value)| format!("{name} = {}", number(*value)));
        let all: Vec<String> = parameters.chain(given).collect();
        let (name, value) = effect.example.gives;
        Self {
            info: &effect.info,
            example: format!("{} give {name} = {}", all.join(", "), number(value)),
        }
    }
}

/// Markdown tables of effects under a heading for what they act on: name, formula, parameters, level, signature, what looks
/// alike, example, source.
///
/// ```
/// use kufe_effect::{CATALOGUE, page};
/// let page = page::tables(CATALOGUE.iter().map(|effect| page::Row::of(effect)));
/// assert!(page.contains("| `speed-grip` | F_y (1 + k (v - v_ref)) | `slope_s_per_m` [s/m]"));
/// ```
pub fn tables(effects: impl Iterator<Item = Row>) -> String {
    let rows: Vec<Row> = effects.collect();
    let mut page = String::new();
    for (on, heading) in GROUPS {
        let mut own = rows
            .iter()
            .filter(|row| row.info.acts_on.first() == Some(&on));
        let Some(first) = own.next() else {
            continue;
        };
        let _ = write!(
            page,
            "\n### {heading}\n\n| name | formula | parameter [unit] | level | signature | looks like | example | source |\n\
             |---|---|---|---|---|---|---|---|\n"
        );
        for row in std::iter::once(first).chain(own) {
            page.push_str(&line(row));
        }
    }
    page.push('\n');
    page
}

fn line(Row { info, example }: &Row) -> String {
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
        match info.judged {
            Judged::ByPressure => "-".to_owned(),
            judged => judged.level().name().to_owned(),
        },
        info.signature.to_owned(),
        info.looks_like.join(", "),
        example.clone(),
        info.source.to_owned(),
    ];
    let cells = cells.map(|text| text.replace('|', "\\|"));
    format!("| {} |\n", cells.join(" | "))
}

/// A number as a page shows it: with a power of ten where it is very large or very small.
///
/// ```
/// assert_eq!(kufe_effect::page::number(9.9e9), "9.9e9");
/// assert_eq!(kufe_effect::page::number(0.0048), "0.0048");
/// ```
pub fn number(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-4..1e6).contains(&size) => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

/// The page with what stands between the marks `<!-- NAME -->` and `<!-- end of NAME -->` replaced by `text`.
///
/// `None` where the page lacks a mark.
///
/// ```
/// let page = "a\n<!-- x -->\nold\n<!-- end of x -->\nb";
/// let new = kufe_effect::page::with_section(page, "x", "new\n").unwrap();
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
