//! `kufe lut` from a table file to the forms that other programs read.

use serde_json::Value;

use crate::kufe::Bench;

const PARABOLOID: &str = r#"[runner]
shape = { kind = "paraboloid", rocker_radius_m = 30.0, section_radius_m = 0.005 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = "half-space"
[load]
fz_n = 1000.0
"#;

fn bench(table: &str) -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", PARABOLOID);
    bench.write("table.toml", format!("case = \"case.toml\"\n{table}"));
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Exit code and standard error.
fn fails(bench: &Bench, words: &[&str]) -> (i32, String) {
    let output = bench.kufe(words);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().expect("an exit code"), printed)
}

/// A command line.
fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

#[test]
fn a_table_of_a_paraboloid_is_that_of_hertz() {
    let bench = bench(
        "[axes]\nfz_n = { values = [250.0, 1000.0, 4000.0] }\nradius_m = { values = [60.0, inf, -60.0] }\n\
         [accuracy]\np_max = 0.005\n",
    );
    let printed = bench.succeeds(&[
        "lut",
        "table.toml",
        "-o",
        "front.lut",
        "--csv",
        "--mat",
        "--header",
        "--fmu=other.fmu",
    ]);
    assert!(printed.contains("fz: 3 points"), "{printed}");
    assert!(printed.contains("curvature: 3 points"), "{printed}");
    let names = [
        "case.toml",
        "front.csv",
        "front.h",
        "front.lut",
        "front.mat",
        "other.fmu",
        "table.toml",
    ];
    assert_eq!(bench.names(), names);
    let table = json(&std::fs::read_to_string(bench.path("front.lut")).unwrap());
    let fz = [250.0, 1000.0, 4000.0];
    // An effective rocker of 30 m at curvature 0; reference/hertz.csv's values for it.
    let exact = [8.726337e7, 1.385220e8, 2.198899e8];
    for (i, p_max) in exact.into_iter().enumerate() {
        let found = table["quantities"]["p_max"]["values"][i][1]
            .as_f64()
            .unwrap();
        assert!((found / p_max - 1.0).abs() < 0.005, "{found} {p_max}");
        assert_eq!(table["axes"][0]["values"][i], fz[i]);
    }
    let curvatures: Vec<f64> = (0..3)
        .map(|j| table["axes"][1]["values"][j].as_f64().unwrap())
        .collect();
    assert_eq!(curvatures, [-1.0 / 60.0, 0.0, 1.0 / 60.0]);
    assert_eq!(table["case"]["ice"]["thickness_m"], "half-space");

    let answer = json(&bench.succeeds(&words(
        "lut query front.lut --fz-n 1000 --radius-m inf --json",
    )));
    assert_eq!(
        answer["p_max_pa"],
        table["quantities"]["p_max"]["values"][1][1]
    );
    for key in [
        "p_max_error_pa",
        "p_mean_pa",
        "area_m2",
        "length_m",
        "width_m",
        "approach_m",
        "fz_n",
    ] {
        assert!(answer[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert_eq!(answer["out_of_range"], false);
    let by_curvature = bench.succeeds(&words(
        "lut query front.lut --fz-n 1000 --curvature-1pm -0.01 --json",
    ));
    let by_pitch = bench.succeeds(&words(
        "lut query front.lut --fz-n 1000 --v-mps 20 --pitch-rate-radps 0.2 --json",
    ));
    assert_eq!(json(&by_curvature), json(&by_pitch));
    let printed = bench.succeeds(&words(
        "lut query front.lut --fz-n 9000 --curvature-1pm 0 --mode bilinear",
    ));
    let place = "outside the table (fz_n = 9000, its range ";
    assert!(printed.contains(place), "{printed}");
    let line = "lut query front.lut --fz-n 1000 --curvature-1pm 0 --v-mps 20";
    let (code, warned) = fails(&bench, &words(line));
    let unused = "--v-mps is not used: the table has no such axis";
    assert!(code == 0 && warned.contains(unused), "{code} {warned}");
    for (inputs, found) in [
        ("--fz-n 9000 --curvature-1pm 0", "fz_n = 9000: "),
        ("--fz-n 1000 --curvature-1pm 0.5", "curvature_1pm = 0.5: "),
    ] {
        let strict = format!("lut query front.lut --strict {inputs}");
        let (code, printed) = fails(&bench, &words(&strict));
        assert!(
            code == 3 && printed.contains(found) && printed.contains("expected"),
            "{printed}"
        );
    }
    bench.succeeds(&words(
        "lut query front.lut --strict --fz-n 1000 --radius-m inf",
    ));
    let printed = bench.succeeds(&[
        "lut",
        "show",
        "front.lut",
        "--quantity",
        "length",
        "-o",
        "length.png",
    ]);
    assert!(
        printed.contains("length.png")
            && std::fs::read(bench.path("length.png")).unwrap().len() > 10_000
    );
    bench.succeeds(&["lut", "export", "front.lut", "--csv=again.csv"]);
    assert_eq!(
        std::fs::read(bench.path("again.csv")).unwrap(),
        std::fs::read(bench.path("front.csv")).unwrap()
    );
}

#[test]
fn a_range_is_refined_until_it_meets_its_accuracy() {
    let bench = bench(
        "[axes]\nfz_n = { from = 250.0, to = 4000.0 }\ncurvature_1pm = { from = -0.02, to = 0.02 }\n\
         [accuracy]\ninterpolation = 0.02\nchecks = 30\nevaluation = \"smooth\"\n",
    );
    let summary = json(&bench.succeeds(&["lut", "table.toml", "-o", "t.lut", "--json"]));
    assert!(summary["interpolation_smooth"].as_f64().unwrap() <= 0.02);
    assert!(summary["solver_p_max"].as_f64().unwrap() <= 0.01);
    assert!(summary["checks"].as_u64().unwrap() >= 30);
    // Independent contacts, solved by `kufe press`.
    for (fz, radius) in [(333.0, 55.0), (2345.0, -210.0), (3900.0, 90.0)] {
        let case = PARABOLOID.replace(
            "[load]\nfz_n = 1000.0",
            &format!(
                "[track]\nradius_m = {radius:.1}\n[load]\nfz_n = {fz:.1}\n[accuracy]\np_max = 0.005"
            ),
        );
        bench.write("one.toml", case);
        let pressed = json(&bench.succeeds(&["press", "one.toml", "--json"]))["p_max_pa"]
            .as_f64()
            .unwrap();
        let (fz, radius) = (fz.to_string(), radius.to_string());
        let looked = json(&bench.succeeds(&[
            "lut",
            "query",
            "t.lut",
            "--fz-n",
            &fz,
            "--radius-m",
            &radius,
            "--json",
        ]));
        let error = looked["p_max_pa"].as_f64().unwrap() / pressed - 1.0;
        assert!(error.abs() < 0.03, "{fz} {radius}: {error}");
    }
}

/// Corners and middle by finite elements, the points between by boundary elements, each within its stated error; all by finite elements where
/// the ice yields.
#[test]
fn a_table_states_the_method_of_each_contact() {
    let axes = "[axes]\nfz_n = { values = [250.0, 500.0, 1000.0, 2000.0, 4000.0] }\n\
                rocker_radius_m = { values = [15.0, 30.0, 60.0, 120.0] }\nradius_m = { values = [inf] }\n[accuracy]\np_max = 0.005\n";
    let bench = bench(axes);
    let printed = bench.succeeds(&["lut", "table.toml", "-o", "both.lut"]);
    assert!(printed.contains("by_boundary_elements: 1"), "{printed}");
    let table = json(&std::fs::read_to_string(bench.path("both.lut")).unwrap());
    let (mut by_boundary, mut by_finite) = (Vec::new(), Vec::new());
    for (i, fz) in [250.0, 500.0, 1000.0, 2000.0, 4000.0]
        .into_iter()
        .enumerate()
    {
        for (k, rocker) in [15.0, 30.0, 60.0, 120.0].into_iter().enumerate() {
            let figure = |name: &str| {
                table["quantities"][name]["values"][i][0][k]
                    .as_f64()
                    .unwrap()
            };
            let exact = kufe_contact::hertz(rocker, 0.005, 9e9 / (1.0 - 0.33 * 0.33), fz).unwrap();
            let off = (figure("p_max") - exact.p_max).abs();
            let error = table["quantities"]["p_max"]["errors"][i][0][k]
                .as_f64()
                .unwrap();
            assert!(off <= error && error <= 0.005 * figure("p_max"));
            assert!(
                (figure("area") / (std::f64::consts::PI * exact.a * exact.b) - 1.0).abs() < 0.03
            );
            assert!((figure("p_mean") * figure("area") / fz - 1.0).abs() < 0.01);
            match table["method"][i][0][k].as_str() {
                Some("boundary-elements") => by_boundary.push((i, k)),
                Some("finite-elements") => by_finite.push((i, k)),
                other => panic!("{other:?}"),
            }
        }
    }
    for corner in [(0, 0), (0, 3), (4, 0), (4, 3), (2, 2)] {
        assert!(by_finite.contains(&corner), "{by_finite:?}");
    }
    assert!(by_boundary.len() >= 10, "{by_finite:?}");
    let reported = json(&bench.succeeds(&["info", "both.lut", "--json"]));
    let checks = table["checks"].as_array().unwrap().iter();
    let of_checks = checks
        .filter(|c| c["method"] == "boundary-elements")
        .count();
    assert_eq!(
        reported["by_boundary_elements"],
        by_boundary.len() + of_checks
    );
    bench.write(
        "case.toml",
        PARABOLOID.replace("[load]", "hardness_pa = 50e6\n[load]"),
    );
    let printed = bench.succeeds(&["lut", "table.toml", "-o", "yields.lut"]);
    assert!(printed.contains("by_boundary_elements: 0\n"), "{printed}");
    let text = std::fs::read_to_string(bench.path("yields.lut")).unwrap();
    assert!(!text.contains("\"method\""));
}

#[test]
fn the_table_has_the_same_bytes_for_any_number_of_threads() {
    let bench = bench(
        "[axes]\nfz_n = { values = [250.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.02] }\n",
    );
    bench.succeeds(&["lut", "table.toml", "-o", "one.lut", "--threads", "1"]);
    bench.succeeds(&["lut", "table.toml", "-o", "three.lut", "--threads", "3"]);
    assert_eq!(
        std::fs::read(bench.path("one.lut")).unwrap(),
        std::fs::read(bench.path("three.lut")).unwrap()
    );
}

#[test]
fn bad_table_files_are_refused_with_key_and_value() {
    let good =
        "[axes]\nfz_n = { values = [250.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.02] }\n";
    for (from, to, expected) in [
        ("250.0, 1000.0", "1000.0, 250.0", "fz_n"),
        ("250.0, 1000.0", "-250.0, 1000.0", "positive"),
        ("250.0, 1000.0", "nan, 1000.0", "finite"),
        (
            "{ values = [250.0, 1000.0] }",
            "{ from = 250.0 }",
            "axes.fz_n",
        ),
        ("curvature_1pm", "curvature", "line 4"),
        (
            "curvature_1pm = { values = [0.0, 0.02] }",
            "radius_m = { values = [0.0] }",
            "axes.radius_m: found 0",
        ),
        (
            "curvature_1pm = { values = [0.0, 0.02] }",
            "",
            "either curvature_1pm or radius_m",
        ),
        (
            "[axes]",
            "[accuracy]\ninterpolation = 7.0\n[axes]",
            "interpolation = 7",
        ),
        (
            "[axes]",
            "[accuracy]\np_max = 0.0\n[axes]",
            "accuracy.p_max = 0",
        ),
        (
            "[axes]",
            "[accuracy]\nsmallest_interval = 0.5\n[axes]",
            "accuracy.smallest_interval = 0.5",
        ),
        (
            "{ values = [0.0, 0.02] }",
            "{ values = [0.0, 0.02], flush = { curvature_1pm = 0.01, scale_1pm_per_n = 1e-8 } }",
            "flush: expected curvatures from one end to another",
        ),
        (
            "{ values = [0.0, 0.02] }",
            "{ from = 0.0, to = 0.02, flush = { curvature_1pm = 0.03, scale_1pm_per_n = 1e-8 } }",
            "flush.curvature_1pm = 0.03",
        ),
        (
            "{ values = [0.0, 0.02] }",
            "{ from = 0.0, to = 0.02, flush = { curvature_1pm = 0.01, scale_1pm_per_n = 0.0 } }",
            "flush.scale_1pm_per_n = 0",
        ),
    ] {
        let bench = bench(&good.replace(from, to));
        let (code, printed) = fails(&bench, &["lut", "table.toml", "-o", "t.lut"]);
        assert!(
            code == 3 && printed.contains(expected),
            "{code} {printed}: no {expected}"
        );
        assert!(!bench.path("t.lut").exists());
    }
    let bench = Bench::new();
    bench.write("table.toml", format!("case = \"absent.toml\"\n{good}"));
    let (code, printed) = fails(&bench, &["lut", "table.toml"]);
    assert!(code == 3 && printed.contains("absent.toml"), "{printed}");
}

#[test]
fn points_short_of_the_tolerance_are_written_reported_and_end_with_code_4() {
    let bench = bench(
        "[axes]\nfz_n = { values = [1000.0] }\ncurvature_1pm = { values = [0.0] }\n[accuracy]\np_max = 1e-5\n",
    );
    let (code, printed) = fails(&bench, &["lut", "table.toml", "-o", "t.lut"]);
    assert_eq!(code, 4, "{printed}");
    assert!(
        printed.contains("1 solve stayed short")
            && printed.contains("tolerance of 0.00100 %")
            && printed.contains("fz_n = 1000"),
        "{printed}"
    );
    let table = json(&std::fs::read_to_string(bench.path("t.lut")).unwrap());
    let error = table["accuracy"]["solver"].as_f64().unwrap();
    assert!(error > 1e-5 && error < 1e-3, "{error}");
    // As the exports, a query has the value at the end of an axis.
    let query = [
        "lut",
        "query",
        "t.lut",
        "--radius-m",
        "inf",
        "--json",
        "--fz-n",
    ];
    let at = |fz: &str| json(&bench.succeeds(&[&query[..], &[fz]].concat()));
    let end = at("1000");
    for fz in ["-5", "0"] {
        let found = at(fz);
        assert_eq!(found["p_max_pa"], end["p_max_pa"], "{fz}");
        assert_eq!(found["out_of_range"], true, "{fz}");
    }
    let (code, printed) = fails(&bench, &[&query[..], &["nan"]].concat());
    assert!(code == 2 && printed.contains("a finite force"), "{printed}");
    let looked = json(&bench.succeeds(&words("lut query t.lut --fz-n 1000 --radius-m inf --json")));
    let (p_max, stated) = (&looked["p_max_pa"], &looked["p_max_error_pa"]);
    // Hertz's peak is 138.52 MPa.
    assert!((p_max.as_f64().unwrap() / 138.52e6 - 1.0).abs() < 1e-3);
    assert!((stated.as_f64().unwrap() / p_max.as_f64().unwrap() / error - 1.0).abs() < 1e-12);
}

#[test]
fn the_rules_of_a_table_file_hold_in_its_queries_and_exports() {
    let bench = bench(
        "[axes]\nfz_n = { values = [250.0, 1000.0, 4000.0], outside = \"linear\" }\n\
         radius_m = { values = [60.0, inf, -60.0], outside = \"error\" }\n[accuracy]\np_max = 0.005\nchecks = 1\n",
    );
    let printed = bench.succeeds(&words(
        "lut table.toml -o front.lut --mat --octave --ctypes --csharp --fmu2",
    ));
    assert!(
        printed.contains("fz: 3 points, from 250 N, to 4 kN"),
        "{printed}"
    );
    assert!(printed.contains("least accurate at fz_n = "), "{printed}");
    let names = [
        "case.toml",
        "front.cs",
        "front.h",
        "front.lut",
        "front.mat",
        "front.py",
        "front_fmi2.fmu",
        "kufe_lut_at.m",
        "table.toml",
    ];
    assert_eq!(bench.names(), names);
    let header = std::fs::read_to_string(bench.path("front.h")).unwrap();
    assert!(header.contains("#define FRONT_FZ_N_OUTSIDE KUFE_LUT_LINEAR\n"));
    assert!(header.contains("#define FRONT_CURVATURE_1PM_OUTSIDE KUFE_LUT_ERROR\n"));
    let p_max = |fz: &str| {
        let line = format!("lut query front.lut --radius-m inf --json --fz-n {fz}");
        let answer = json(&bench.succeeds(&words(&line)));
        assert_eq!(answer["out_of_range"], fz == "32000");
        answer["p_max_pa"].as_f64().unwrap()
    };
    // Hertz: eight times the force has twice the peak; the nodes are within half a per cent of it.
    let ratio = p_max("32000") / p_max("4000");
    assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
    let line = "lut query front.lut --fz-n 1000 --radius-m 20";
    let (code, printed) = fails(&bench, &words(line));
    assert!(
        code == 3 && printed.contains("curvature_1pm = 0.05: outside the table"),
        "{printed}"
    );
    let facts = json(&bench.succeeds(&words("info front_fmi2.fmu --json")));
    assert_eq!(facts["axes"]["fz_n"]["outside"], "linear");
    assert_eq!(facts["axes"]["curvature_1pm"]["outside"], "error");

    bench.write(
        "wrong.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [250.0] }\nradius_m = { values = [inf] }\n\
         rocker_radius_m = { values = [20.0, 30.0], outside = \"linear\" }\n",
    );
    let (code, printed) = fails(&bench, &words("lut wrong.toml -o wrong.lut"));
    assert!(
        code == 3 && printed.contains("rocker_radius_m.outside"),
        "{printed}"
    );
}

#[test]
fn bad_tables_and_arguments_are_refused() {
    let bench = Bench::new();
    bench.write("broken.lut", "{\"format\": \"kufe-lut\"");
    let query = words("lut query broken.lut --fz-n 1 --radius-m inf");
    let (code, printed) = fails(&bench, &query);
    assert!(
        code == 3 && printed.contains("broken.lut: ") && printed.contains("line 1"),
        "{printed}"
    );
    for line in [
        "lut",
        "lut query broken.lut --fz-n 1",
        "lut query broken.lut --fz-n 1 --radius-m 3 --curvature-1pm 3",
        "lut show broken.lut --quantity colour",
        "lut export broken.lut",
        "lut run plan --shard 0/4",
        "lut run plan --shard 5/4",
        "lut plan t.toml -o p --shards 0",
    ] {
        let (code, printed) = fails(&bench, &words(line));
        assert_eq!(code, 2, "{line}: {printed}");
    }
    // The header of --ctypes has the name of the CSV file.
    let line = "lut export broken.lut --csv=broken.h --ctypes";
    let (code, printed) = fails(&bench, &words(line));
    assert!(
        code == 3 && printed.contains("writes another of its outputs there"),
        "{printed}"
    );
}
