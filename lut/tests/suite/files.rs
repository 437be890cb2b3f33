//! `.lut` files: read back to the bit, and refused with the place of what is wrong.

use crate::tables::{reduced, sliding, table};
use kufe_lut::{Figures, Method, Solve, Table};

fn text(table: &Table) -> String {
    let mut bytes = Vec::new();
    table.write(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// The errors of a file with one replacement.
fn refused(good: &str, cases: &[(&str, &str, &str)]) {
    for (from, to, expected) in cases {
        assert!(good.contains(from), "{from}");
        let broken = good.replace(from, to);
        let Err(error) = Table::read(&mut broken.as_bytes()) else {
            panic!("{from} may be {to}");
        };
        let error = error.to_string();
        assert!(
            error.contains(expected),
            "{error} does not contain {expected}"
        );
    }
}

/// A table of which boundary elements solved every third node, and the checks.
fn by_both(rocker: bool) -> Table {
    let of = table(rocker);
    let by = |n: usize, figures: Figures| match n % 3 {
        0 => figures.by(Method::BoundaryElements),
        _ => figures,
    };
    let nodes = of.nodes().iter().copied().enumerate();
    let nodes = nodes.map(|(n, figures)| by(n, figures));
    let checks = of.checks().iter().map(|check| Solve {
        figures: by(0, check.figures),
        ..*check
    });
    let nodes: Vec<Figures> = nodes.collect();
    Table::new(of.axes().clone(), &nodes, checks.collect()).unwrap()
}

#[test]
fn a_file_read_back_is_the_same_table_to_the_bit() {
    for table in [
        table(false),
        table(true),
        reduced(),
        by_both(true),
        sliding(false),
        sliding(true),
    ] {
        let written = text(&table);
        let back = Table::read(&mut written.as_bytes()).unwrap();
        assert_eq!(back, table);
        assert_eq!(text(&back), written);
    }
}

#[test]
fn methods_have_the_shape_of_the_nodes_and_are_omitted_where_they_are_the_default() {
    assert!(!text(&table(false)).contains("method"));
    let good = text(&by_both(false));
    let value: serde_json::Value = serde_json::from_str(&good).unwrap();
    assert_eq!(value["method"].as_array().map(Vec::len), Some(5));
    assert_eq!(value["method"][0][3], "boundary-elements");
    assert_eq!(value["method"][0][4], "finite-elements");
    assert_eq!(value["checks"][0]["method"], "boundary-elements");
    refused(
        &good,
        &[
            ("[[\"boundary-elements\"", "[[\"guesses\"", "`guesses`"),
            ("[[\"boundary-elements\",", "[[", "list of 5 entries"),
            (
                "\"method\":\"boundary-elements\"",
                "\"method\":1",
                "expected value",
            ),
        ],
    );
}

#[test]
fn broken_files_are_named_by_place() {
    let good = text(&table(false));
    refused(
        &good,
        &[
            ("\"kufe-lut\"", "\"other\"", "format: found other"),
            (
                "\"format_version\": 1",
                "\"format_version\": 9",
                "format_version: found 9",
            ),
            (
                "\"fz_n\",\"unit\"",
                "\"f\",\"unit\"",
                "axes[0].name: found f, expected fz_n",
            ),
            (
                "\"unit\":\"N\"",
                "\"unit\":\"kN\"",
                "axes[0].unit: found kN, expected N",
            ),
            ("[200.0,500.0", "[500.0,500.0", "fz_n, value 1 = 500"),
            (
                "[200.0,500.0",
                "[null,500.0",
                "invalid type: null, expected a finite number",
            ),
            ("[200.0,500.0", "[1e999,500.0", "number out of range"),
            (
                "\"p_mean\": {\"unit",
                "\"p_meen\": {\"unit",
                "unknown variant `p_meen`",
            ),
            (
                "\"unit\":\"Pa\"",
                "\"unit\":\"MPa\"",
                "quantities.p_max.unit: found MPa",
            ),
            (
                "\"area\": {\"unit\":\"m2\",\"values\":[[",
                "\"area\": {\"unit\":\"m2\",\"values\":[[1.0,",
                "found a list of 5 entries, expected 6",
            ),
            (
                "\"area\": {\"unit\":\"m2\",\"values\":[[",
                "\"area\": {\"unit\":\"m2\",\"values\":[[-",
                "quantities.area.values, number 1: found -",
            ),
            (
                "\"errors\":[[0.0",
                "\"errors\":[[-1.0",
                "expected 0 or a positive number",
            ),
            (
                "\"errors\":[[0.0",
                "\"errors\":[[5e-324",
                "errors, number 1: found 0.000",
            ),
            ("\"checks\": [", "\"checks\": [3,", "invalid type"),
            (
                "\"checks\": [\n {\"fz_n\"",
                "\"checks\": [\n {\"f\"",
                "unknown key f",
            ),
            (
                "\"version\": \"0",
                "\"vorsion\": \"0",
                "unknown field `vorsion`",
            ),
            (
                "\"version\": \"0",
                "\"version\": \"*/ 0",
                "version: found */ 0",
            ),
            ("0123abcd", "0123wxyz", "expected 64 hexadecimal digits"),
            ("0123abcd", "0123", "expected 64 hexadecimal digits"),
        ],
    );
    let error = |text: &str| Table::read(&mut text.as_bytes()).unwrap_err().to_string();
    assert!(error(&good[..good.len() / 2]).contains("line"));
    assert!(error("").contains("line 1"));
    assert!(error(&"[".repeat(100_000)).contains("line 1"));
    let huge = good.replacen("[200.0", &format!("[{}200.0", "1.0,".repeat(5000)), 1);
    assert!(error(&huge).contains("expected at most 4096 entries"));
}

#[test]
fn broken_reduced_axes_are_named_by_place() {
    refused(
        &text(&reduced()),
        &[
            (
                "\"name\":\"reduced_curvature\"",
                "\"name\":\"curvature_1pm\"",
                "axes[1]",
            ),
            (
                "\"scale_1pm_per_n\":1e-6",
                "\"scale_1pm_per_n\":-1.0",
                "scale_1pm_per_n = -1",
            ),
            (
                "\"from_1pm\":-0.02",
                "\"from_1pm\":0.7",
                "flush.curvature_1pm = 0.02",
            ),
            ("\"to_1pm\"", "\"two_1pm\"", "unknown field `two_1pm`"),
            ("0.8,1.0]", "0.8,1.5]", "reduced_curvature, value 5 = 1.5"),
        ],
    );
}

#[test]
fn broken_tables_that_slide_are_named_by_place() {
    refused(
        &text(&sliding(false)),
        &[
            ("\"name\":\"v_mps\"", "\"name\":\"ice_c\"", "axes[2].unit"),
            (
                "\"name\":\"ice_c\"",
                "\"name\":\"fog\"",
                "axes[3].name: found fog, expected ice_c",
            ),
            ("[2.0,6.0,14.0", "[-2.0,6.0,14.0", "v_mps, value 0 = -2"),
            (
                "\"mu\": {\"unit\":\"1\"",
                "\"mu\": {\"unit\":\"Pa\"",
                "quantities.mu.unit",
            ),
            ("\"ice_c\":-4.0", "\"ice_c\":-40.0", "checks[0].ice_c"),
            ("\"ice_c\":-4.0,", "", "checks[0].ice_c: found nothing"),
        ],
    );
}
