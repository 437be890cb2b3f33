//! docs/case.md names every key of a case, and no other.

use std::collections::BTreeSet;

use kufe_case::Case;

const PAGE: &str = include_str!("../../../docs/case.md");

/// Tables of a case, each as a text in which the key `nowhere` is the first thing wrong.
const TABLES: [(&str, &str); 14] = [
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
    ("accuracy", "[accuracy]\nnowhere = 1"),
    ("solver", "[solver]\nnowhere = 1"),
];

/// The keys that the reader itself names when it meets an unknown one.
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
    let told: BTreeSet<String> = PAGE
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'))
        .map(|(key, _)| key.to_owned())
        .collect();
    let missing: Vec<_> = read.difference(&told).collect();
    let unknown: Vec<_> = told.difference(&read).collect();
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "docs/case.md lacks {missing:?} and tells of {unknown:?}"
    );
}

#[test]
fn units_on_the_page_are_those_of_the_keys_suffixes() {
    for line in PAGE.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (key, unit) = (cells[1].trim_matches('`'), cells[2]);
        let expected = [
            ("_1pm", "1/m"),
            ("_pa", "Pa"),
            ("_mps", "m/s"),
            ("_rad", "rad"),
            ("_c", "C"),
            ("_n", "N"),
            ("_m", "m"),
        ]
        .into_iter()
        .find(|(suffix, _)| key.ends_with(suffix))
        .map_or("", |(_, unit)| unit);
        assert_eq!(unit, expected, "{key}");
    }
}
