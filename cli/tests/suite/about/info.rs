//! `kufe info` of a lookup table.

use serde_json::Value;

use crate::kufe::{Bench, CASE, errors};

#[test]
fn info_tells_a_tables_axes_quantities_errors_and_version() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "table.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.01] }\n",
    );
    bench.succeeds(&["lut", "table.toml", "-o", "bob.lut"]);
    let facts: Value =
        serde_json::from_str(&bench.succeeds(&["info", "bob.lut", "--json"])).expect("JSON");
    assert_eq!(facts["kind"], "lookup table");
    assert_eq!(facts["nodes"], 4);
    assert_eq!(facts["axes"]["fz_n"]["points"], 2);
    assert_eq!(facts["axes"]["fz_n"]["from"], 500.0);
    assert_eq!(facts["axes"]["curvature_1pm"]["to"], 0.01);
    assert_eq!(facts["version"], env!("CARGO_PKG_VERSION"));
    let error = facts["solver_error_p_max"].as_f64().expect("an error");
    assert!(error > 0.0 && error <= 0.02, "{error}");
    let p_max = &facts["quantities"]["p_max_pa"];
    let [min, max] = ["min", "max"].map(|key| p_max[key].as_f64().expect(key));
    // Pressed harder and in a bend, the peak rises and falls: its range holds Hertz's 138.5 MPa at 1 kN, flat.
    assert!(
        min < 110e6 && (max / 138.5e6 - 1.0).abs() < 0.03,
        "{min} to {max}"
    );
    let said = bench.succeeds(&["info", "bob.lut"]);
    for word in ["p_max_pa:", "area_m2:", "approach_m:", "case_sha256: "] {
        assert!(said.contains(word), "{word:?} is missing: {said}");
    }
}

#[test]
fn infinite_numbers_are_told_as_what_they_are() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "table.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\nradius_m = { values = [inf, 60.0] }\n",
    );
    let said = bench.succeeds(&["info", "table.toml"]);
    assert!(said.contains("values: inf, 60\n"), "{said}");
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    let said = bench.succeeds(&["info", "out/pressure.exr"]);
    assert!(said.contains("radius_m: inf\n"), "{said}");
}

#[test]
fn what_info_shows_is_read_by_people() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("table.toml", "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.01] }\n");
    bench.succeeds(&["init", "--kind", "model", "model.toml"]);
    bench.succeeds(&["lut", "table.toml", "-o", "bob.lut"]);
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    bench.succeeds(&["man", "-o", "man"]);
    bench.succeeds(&["man", "--markdown", "reference.md"]);
    // Laws of a fit have their intervals; their product ends in _c and is no temperature.
    let law = r#"{ "k_n_per_rad": { "value": 9e3, "low": 8e3, "high": 1e4 }, "mu_zeta_c": { "value": 0.06, "low": 0.05, "high": 0.07 } }"#;
    let fit = format!(r#"{{ "front": {law}, "rear": {law}, "excluded_contacts": 3 }}"#);
    bench.write("fit.json", fit);
    for (file, expected) in [
        ("model.toml", "k_n_per_rad: 10522 N/rad\n"),
        ("model.toml", "yaw_drag_per_deg: 0.06940 1/deg\n"),
        ("case.toml", &format!("size_bytes: {} bytes\n", CASE.len())),
        ("model.schema.json", "required: sled, friction\n"),
        ("model.schema.json", "properties: "),
        ("bob.lut", " MPa, smooth within 0."),
        ("out/result.json", "warnings:\n  the peak of "),
        ("out/result.json", "symmetry: true, true\n"),
        ("out/pressure.exr", "p: F32, contact pressure [Pa]\n"),
        (
            "fit.json",
            "k_n_per_rad: 9000 N/rad (8000 to 10000 N/rad)\n",
        ),
        ("fit.json", "mu_zeta_c: 0.06000 (0.05000 to 0.07000)\n"),
        ("man/kufe-press.1", "kind: a manual page\n"),
        ("reference.md", "kind: the command's reference\n"),
    ] {
        let said = bench.succeeds(&["info", file]);
        assert!(said.contains(expected), "{file}: no {expected:?} in {said}");
        assert!(!said.contains("[\""), "{said}");
    }
}

#[test]
fn a_file_that_is_no_table_is_refused_with_its_name() {
    let bench = Bench::new();
    bench.write("bad.lut", "{\"format\": \"something else\"}");
    let output = bench.kufe(&["info", "bad.lut"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(errors(&output).contains("bad.lut: "), "{}", errors(&output));
}
