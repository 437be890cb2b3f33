//! `docs/effects.md` lists the catalogues of effects.

use std::fmt::Write as _;
use std::path::Path;

use kufe::case::effects::CATALOGUE as ON_PRESSURES;
use kufe_sled::effects::{ActsOn, CATALOGUE, Info, columns_of_forces, columns_of_sensors};

#[test]
fn the_page_lists_the_catalogues() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let columns = format!(
        "On forces: `{}`. On a sensor: `{}`.\n",
        columns_of_forces().join(" "),
        columns_of_sensors().join(" ")
    );
    let sections = [
        (
            "effects of the sled",
            tables(CATALOGUE.iter().map(|e| e.info())),
        ),
        ("columns of expressions", columns),
        (
            "effects on pressures",
            tables(ON_PRESSURES.iter().map(|e| e.info())),
        ),
    ];
    let wanted = sections.iter().fold(page.clone(), |page, (name, text)| {
        with_section(&page, name, text).expect("the page has its marks")
    });
    if std::env::var_os("KUFE_WRITE_DOCS").is_some() {
        std::fs::write(&path, wanted).unwrap();
        return;
    }
    assert!(
        page == wanted,
        "docs/effects.md differs from the catalogues; write it anew: \
         KUFE_WRITE_DOCS=1 cargo test --release -p kufe page"
    );
}

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

/// Markdown tables of effects under a heading for what they act on: name, formula, parameters, signature, similar effects.
/// Sources stay in the catalogues.
fn tables(effects: impl Iterator<Item = &'static Info>) -> String {
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

/// The page with the text between the marks `<!-- NAME -->` and `<!-- end of NAME -->` replaced by `text`.
///
/// `None` where the page has no such mark.
fn with_section(page: &str, name: &str, text: &str) -> Option<String> {
    let (from, to) = (
        format!("<!-- {name} -->\n"),
        format!("<!-- end of {name} -->"),
    );
    let begin = page.find(&from)? + from.len();
    let end = begin + page[begin..].find(&to)?;
    Some(format!("{}{text}{}", &page[..begin], &page[end..]))
}
