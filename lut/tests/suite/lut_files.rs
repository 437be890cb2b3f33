//! `.lut` files: read back to the bit, and refused with the place of what is wrong.

use crate::tables::{reduced, table};
use kufe_lut::Table;

#[test]
fn a_file_read_back_is_the_same_table_to_the_bit() {
    for table in [table(false), table(true), reduced(), by_both(true)] {
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        let back = Table::read(&mut bytes.as_slice()).unwrap();
        assert_eq!(back, table);
        let mut again = Vec::new();
        back.write(&mut again).unwrap();
        assert_eq!(again, bytes);
    }
}

/// A table of which boundary elements solved every third node, and the checks.
fn by_both(rocker: bool) -> Table {
    let of = table(rocker);
    let method = kufe_lut::Method::BoundaryElements;
    let mut nodes = of.nodes().to_vec();
    nodes
        .iter_mut()
        .step_by(3)
        .for_each(|node| node.method = method);
    let mut checks = of.checks().to_vec();
    checks
        .iter_mut()
        .for_each(|check| check.solved.method = method);
    Table::new(of.axes().clone(), nodes, checks).unwrap()
}

#[test]
fn methods_stand_in_the_shape_of_the_nodes_and_only_where_they_differ() {
    let text = |table: &Table| {
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    assert!(!text(&table(false)).contains("method"));
    let good = text(&by_both(false));
    let value: serde_json::Value = serde_json::from_str(&good).unwrap();
    assert_eq!(value["method"].as_array().map(Vec::len), Some(5));
    assert_eq!(value["method"][0][3], "boundary-elements");
    assert_eq!(value["method"][0][4], "finite-elements");
    assert_eq!(value["checks"][0]["method"], "boundary-elements");
    for (from, to, expected) in [
        (
            "[[\"boundary-elements\"",
            "[[\"guesses\"",
            "method[0][0]: found \"guesses\"",
        ),
        (
            "[[\"boundary-elements\",",
            "[[",
            "method[0]: found 4 entries",
        ),
        (
            "\"method\":\"boundary-elements\"",
            "\"method\":1",
            "checks[0].method: found 1",
        ),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good);
        let told = Table::read(&mut bad.as_bytes()).unwrap_err().to_string();
        assert!(told.contains(expected), "{told}");
    }
}

#[test]
fn broken_files_are_named_by_place() {
    let mut bytes = Vec::new();
    table(false).write(&mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    let told = |text: &str| Table::read(&mut text.as_bytes()).unwrap_err().to_string();
    for (from, to, expected) in [
        ("\"kufe-lut\"", "\"other\"", "format: found other"),
        (
            "\"format_version\": 1",
            "\"format_version\": 9",
            "format_version: found 9",
        ),
        ("\"fz_n\",\"unit\"", "\"f\",\"unit\"", "axes[0]: found f"),
        ("[200.0,500.0", "[500.0,500.0", "value 1 = 500"),
        (
            "[200.0,500.0",
            "[null,500.0",
            "axes[0].values[0]: found null",
        ),
        (
            "\"p_mean\": {\"unit",
            "\"p_meen\": {\"unit",
            "quantities: found the key p_meen",
        ),
        (
            "\"unit\":\"Pa\"",
            "\"unit\":\"MPa\"",
            "quantities.p_max: found MPa",
        ),
        (
            "\"area\": {\"unit\":\"m2\",\"values\":[[",
            "\"area\": {\"unit\":\"m2\",\"values\":[[1.0,",
            "quantities.area.values[0]",
        ),
        (
            "\"checks\": [",
            "\"checks\": [3,",
            "checks[0]: found a number",
        ),
        ("\"version\": ", "\"vorsion\": ", "vorsion"),
    ] {
        assert!(good.contains(from), "{from}");
        let text = told(&good.replacen(from, to, 1));
        assert!(text.contains(expected), "{text} lacks {expected}");
    }
    assert!(told(&good[..good.len() / 2]).contains("line"));
    assert!(told("").contains("line 1"));
    let deep = "[".repeat(100_000);
    assert!(told(&deep).contains("recursion"));
    let huge = good.replacen("[200.0", &format!("[{}200.0", "1.0,".repeat(5000)), 1);
    assert!(told(&huge).contains("axis fz_n has"));
}

#[test]
fn broken_reduced_axes_are_named_by_place() {
    let mut bytes = Vec::new();
    reduced().write(&mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    for (from, to, expected) in [
        ("\"format_version\": 2", "\"format_version\": 1", "axes[1]"),
        (
            "\"scale_1pm_per_n\":1e-6",
            "\"scale_1pm_per_n\":-1.0",
            "flush.scale_1pm_per_n = -1",
        ),
        (
            "\"from_1pm\":-0.02",
            "\"from_1pm\":0.7",
            "flush.curvature_1pm = 0.02",
        ),
        (
            "\"to_1pm\"",
            "\"two_1pm\"",
            "axes[1].flush: found the key two_1pm",
        ),
        (
            "0.8,1.0]",
            "0.8,1.5]",
            "axis reduced_curvature, value 5 = 1.5",
        ),
    ] {
        assert!(good.contains(from), "{from}\n{}", &good[..900]);
        let text = Table::read(&mut good.replacen(from, to, 1).as_bytes())
            .unwrap_err()
            .to_string();
        assert!(text.contains(expected), "{text} lacks {expected}");
    }
}
