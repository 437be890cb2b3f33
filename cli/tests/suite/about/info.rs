//! `kufe info`: hulls, tables, maps and results.

use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, refused};

#[test]
fn info_shows_a_tables_axes_quantities_errors_and_version() {
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
    // Pressed harder and in a bend, the peak rises and falls: its range contains Hertz's 138.5 MPa at 1 kN, flat.
    assert!(
        min < 110e6 && (max / 138.5e6 - 1.0).abs() < 0.03,
        "{min} to {max}"
    );
    let printed = bench.succeeds(&["info", "bob.lut"]);
    for word in ["p_max:", "area:", "approach:", "case_sha256: "] {
        assert!(printed.contains(word), "{word:?} is missing: {printed}");
    }
}

#[test]
fn what_info_shows_is_read_by_people() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("table.toml", "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.01] }\n");
    bench.succeeds(&["lut", "table.toml", "-o", "bob.lut"]);
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    // Laws of a fit have their intervals; their product ends in _c and is no temperature.
    let law = r#"{ "k_n_per_rad": { "value": 9e3, "low": 8e3, "high": 1e4 }, "mu_zeta_c": { "value": 0.06, "low": 0.05, "high": 0.07 } }"#;
    let fit = format!(r#"{{ "front": {law}, "rear": {law}, "excluded_contacts": 3 }}"#);
    bench.write("fit.json", fit);
    for (file, expected) in [
        ("bob.lut", " MPa, smooth within 0."),
        ("out/result.json", "warnings:\n  the peak of "),
        ("out/result.json", "symmetry: true, true\n"),
        ("out/pressure.exr", "channels: gap, p, uz\n"),
        ("out/pressure.exr", "radius: inf\n"),
        ("out/hull.glb", "length: "),
        ("fit.json", "k: 9 (8 to 10) kN/rad\n"),
        ("fit.json", "mu_zeta_c: 0.06000 (0.05000 to 0.07000)\n"),
    ] {
        let printed = bench.succeeds(&["info", file]);
        assert!(
            printed.contains(expected),
            "{file}: no {expected:?} in {printed}"
        );
        assert!(!printed.contains("[\""), "{printed}");
    }
}

#[test]
fn unknown_files_end_with_one_error_that_names_the_expected_ones() {
    let bench = Bench::new();
    for (name, content, expected) in [
        ("notes.txt", "hello", "kind \".txt\" is not known"),
        ("a.json", "{\"a\": 1}", "not a result of kufe"),
        ("b.json", "{", "b.json: EOF"),
        ("a.fmu", "PK", "a.fmu: "),
        ("a.exr", "v", "a.exr: "),
        ("a.glb", "glTF", "a.glb: "),
    ] {
        bench.write(name, content);
        refused(bench.folder.path(), &["info", name], 3, &[expected]);
    }
    refused(bench.folder.path(), &["info", "."], 3, &["is a folder"]);
    let missing = ["info", "nothing.json"];
    refused(bench.folder.path(), &missing, 3, &["cannot be read"]);
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    let map = std::fs::read(bench.folder.path().join("out/pressure.exr")).unwrap();
    let cut = bench.folder.path().join("cut.exr");
    std::fs::write(&cut, &map[..map.len() / 2]).unwrap();
    refused(bench.folder.path(), &["info", "cut.exr"], 3, &["cut.exr: "]);
}

#[test]
fn a_file_that_is_no_table_is_refused_with_its_name() {
    let bench = Bench::new();
    bench.write("bad.lut", "{\"format\": \"something else\"}");
    let output = bench.kufe(&["info", "bad.lut"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(errors(&output).contains("bad.lut: "), "{}", errors(&output));
}
