//! docs/case.md names every key of a case, and no other.

use std::collections::BTreeSet;

use kufe::case::{Case, RANGES};
use serde_json::Value;

const PAGE: &str = include_str!("../../../docs/case.md");

/// Tables of a case, each as a text in which the key `nowhere` is the first thing wrong.
const TABLES: [(&str, &str); 15] = [
    ("", "nowhere = 1"),
    ("runner", "[runner]\nnowhere = 1"),
    (
        "runner.shape",
        "[runner]\nshape = { kind = \"bob\", nowhere = 1 }",
    ),
    (
        "runner.shape",
        "[runner]\nshape = { kind = \"luge\", nowhere = 1 }",
    ),
    (
        "runner.shape",
        "[runner]\nshape = { kind = \"paraboloid\", nowhere = 1 }",
    ),
    ("runner.section", "[runner.section]\nnowhere = 1"),
    ("ice", "[ice]\nnowhere = 1"),
    ("ice.bed", "[ice.bed]\nnowhere = 1"),
    ("ice.waviness", "[ice.waviness]\nnowhere = 1"),
    ("track", "[track]\nnowhere = 1"),
    ("load", "[load]\nnowhere = 1"),
    ("sliding", "[sliding]\nnowhere = 1"),
    ("sliding.hardness", "[sliding]\nhardness = { nowhere = 1 }"),
    ("accuracy", "[accuracy]\nnowhere = 1"),
    ("solver", "[solver]\nnowhere = 1"),
];

/// The keys that the reader names in the error of an unknown one.
fn keys(text: &str) -> Vec<String> {
    let error = Case::parse(text).expect_err("an unknown key").to_string();
    let (_, expected) = error
        .split_once("unknown field `nowhere`, expected ")
        .unwrap_or_else(|| panic!("{text}: {error}"));
    expected
        .split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_page_names_every_key_of_a_case_and_no_other() {
    let mut read = BTreeSet::from(["runner.shape.kind".to_owned()]);
    for (table, text) in TABLES {
        for key in keys(text) {
            match table {
                "" if key == "effects" => read.insert(key),
                "" => true,
                table => read.insert(format!("{table}.{key}")),
            };
        }
    }
    let reported: BTreeSet<String> = PAGE
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'))
        .map(|(key, _)| key.to_owned())
        .collect();
    let missing: Vec<_> = read.difference(&reported).collect();
    let unknown: Vec<_> = reported.difference(&read).collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "docs/case.md does not name {missing:?}, and names {unknown:?}, which are no keys"
    );
}

#[test]
fn the_page_states_the_range_of_every_number() {
    let ranges = RANGES
        .iter()
        .filter(|range| !range.key.starts_with("runner.mount."));
    let mut page = PAGE.to_owned();
    for range in ranges {
        // Lists are described in words below the tables.
        let start = format!("| `{}` |", range.key);
        let line = PAGE.lines().find(|line| line.starts_with(&start));
        let line = line.unwrap_or_else(|| panic!("{} has no row", range.key));
        let mut cells: Vec<&str> = line.split('|').collect();
        let words = format!(" {} ", range.words());
        cells[3] = &words;
        page = page.replace(line, &cells.join("|"));
    }
    if std::env::var_os("KUFE_WRITE_DOCS").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/case.md");
        std::fs::write(path, page).expect("docs/case.md");
        return;
    }
    assert!(
        page == PAGE,
        "KUFE_WRITE_DOCS=1 cargo test -p kufe writes the ranges anew"
    );
}

/// Every schema of a number with this key, with its bounds.
fn bounds(schema: &Value, name: &str, found: &mut Vec<[Option<f64>; 2]>) {
    let Some(object) = schema.as_object() else {
        for entry in schema.as_array().into_iter().flatten() {
            bounds(entry, name, found);
        }
        return;
    };
    if let Some(property) = object.get("properties").and_then(|p| p.get(name)) {
        found.push(["minimum", "maximum"].map(|key| property[key].as_f64()));
    }
    object.values().for_each(|value| bounds(value, name, found));
}

/// The bounds of numbers that are one of several forms.
fn numbers(schema: &Value) -> Vec<[Option<f64>; 2]> {
    let own = schema["anyOf"].as_array().into_iter().flatten();
    let mut found: Vec<_> = own
        .map(|form| ["minimum", "maximum"].map(|key| form[key].as_f64()))
        .collect();
    if let Some(object) = schema.as_object() {
        found.extend(object.values().flat_map(numbers));
    }
    found
}

#[test]
fn the_schema_bounds_numbers_as_the_reader_does() {
    let schema = schemars::schema_for!(Case).to_value();
    for range in RANGES {
        let name = range.key.rsplit('.').next().expect("a name");
        let expected = [
            Some(range.low),
            range.high.is_finite().then_some(range.high),
        ];
        if ["thickness_m", "hardness_pa"].contains(&name) {
            // Words are allowed there too: the number is one of several forms.
            let found = numbers(&schema);
            assert!(found.contains(&expected), "{}: {found:?}", range.key);
            continue;
        }
        let mut found = Vec::new();
        bounds(&schema, name, &mut found);
        assert!(found.contains(&expected), "{}: {found:?}", range.key);
    }
}

#[test]
fn no_error_message_has_a_number_of_hundreds_of_digits() {
    let text = |fz: &str| {
        format!(
            "[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005 }}\n[ice]\n\
             youngs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n[load]\nfz_n = {fz}\n"
        )
    };
    for value in ["1e300", "-1e300", "1e-300", "inf", "nan"] {
        let error = Case::parse(&text(value)).expect_err(value).to_string();
        let reported = error.contains("load.fz_n = ") && error.contains("0.001 to 1e7");
        assert!(reported && error.len() < 120, "{error}");
    }
    assert!(Case::parse(&text("1e7")).is_ok());
}
