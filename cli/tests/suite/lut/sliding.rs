//! `kufe lut` of a case that slides.

use serde_json::Value;

use crate::kufe::Bench;

const CASE: &str = "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
    [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
    [load]\nfz_n = 900.0\ntilt = \"fixed\"\n[track]\ncurvature_1pm = 0.004\n[accuracy]\np_max = 0.05\n";

fn bench(sliding: &str, axes: &str) -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", format!("{CASE}{sliding}"));
    let checks = "[accuracy]\nchecks = 0\n";
    bench.write(
        "table.toml",
        format!("case = \"case.toml\"\n[axes]\n{axes}{checks}"),
    );
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn a_node_equals_press_at_that_load_track_speed_and_ice() {
    let axes = "fz_n = { values = [600.0, 900.0] }\ncurvature_1pm = { values = [0.004] }\n\
                v_mps = { values = [6.0, 25.0] }\nice_c = { values = [-9.0, -4.0] }\n";
    let bench = bench("[sliding]\nv_mps = 11.0\nice_c = -2.0\n", axes);
    let printed = bench.succeeds(&["lut", "table.toml", "-o", "front.lut", "--csv"]);
    for axis in ["fz: 2", "curvature: 1", "v: 2", "ice: 2"] {
        assert!(printed.contains(&format!("{axis} points")), "{printed}");
    }
    bench.write(
        "case.toml",
        format!("{CASE}[sliding]\nv_mps = 25.0\nice_c = -4.0\n"),
    );
    bench.succeeds(&["press", "case.toml", "-o", "press"]);
    let pressed = crate::kufe::json(&bench.path("press/result.json"));
    let node = "query front.lut --fz-n 900 --curvature-1pm 0.004 --v-mps 25 --ice-c -4 --json";
    let looked = json(&bench.succeeds(&[&["lut"], &*node.split(' ').collect::<Vec<_>>()].concat()));
    for key in [
        "mu",
        "mu_ploughing",
        "mu_viscous",
        "mu_boundary",
        "groove_depth_m",
        "film_mean_m",
        "p_max_pa",
        "area_m2",
        "length_m",
    ] {
        // Another order of the same steps may round in another way, no more.
        let (a, b) = (
            looked[key].as_f64().unwrap(),
            pressed[key].as_f64().unwrap(),
        );
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{key}: {a} {b}");
    }
    assert_eq!(looked["out_of_range"], false);
    let outside = bench.succeeds(&[
        "lut",
        "query",
        "front.lut",
        "--fz-n",
        "900",
        "--radius-m",
        "250",
        "--v-mps",
        "26",
        "--ice-c",
        "-4",
    ]);
    assert!(
        outside.contains("outside the table") && outside.contains("coefficient of friction"),
        "{outside}"
    );
    // No solve states an error of the groove's depth.
    let with_solver = outside
        .lines()
        .find(|line| line.starts_with("errors of interpolation and"));
    assert!(with_solver.is_some_and(|line| !line.contains("depth of the groove")));
    let without = |line: &str| {
        let is_without = line.contains("none of the solver") || line.starts_with("no error");
        is_without && line.contains("depth of the groove")
    };
    assert!(outside.lines().any(without), "{outside}");
    let output = bench.kufe(&[
        "lut",
        "query",
        "front.lut",
        "--fz-n",
        "900",
        "--radius-m",
        "250",
        "--v-mps",
        "26",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--ice-c"));
    bench.succeeds(&["lut", "show", "front.lut", "--v-mps", "6"]);
    bench.succeeds(&["report", "front.lut"]);
    let facts = json(&bench.succeeds(&["info", "front.lut", "--json"]));
    assert_eq!(facts["axes"]["ice_c"]["from"], -9.0);
}

#[test]
fn a_rocker_that_the_case_cannot_have_is_refused_before_any_point_is_solved() {
    let axes = "fz_n = { values = [600.0, 900.0] }\ncurvature_1pm = { values = [0.0] }\n\
                rocker_radius_m = { values = [5.0, 30.0] }\n";
    let bench = bench("[sliding]\nv_mps = 11.0\nice_c = -2.0\n", axes);
    let shape = "kind = \"bob\", length_m = 1.0, width_m = 0.010, height_m = 0.030, ";
    let case = std::fs::read_to_string(bench.path("case.toml")).expect("the case");
    bench.write("case.toml", case.replace("kind = \"paraboloid\", ", shape));
    let output = bench.kufe(&["lut", "table.toml", "-o", "front.lut"]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{printed}");
    let place =
        "table.toml: axes.rocker_radius_m = 5: case.toml: runner.shape: height [m]: found 0.03";
    assert!(printed.contains(place), "{printed}");
    assert!(!bench.path("front.lut.points").exists());
}

#[test]
fn wrong_sliding_tables_are_refused_with_their_place() {
    let axes = |further: &str| {
        format!(
            "fz_n = {{ values = [600.0, 900.0] }}\ncurvature_1pm = {{ values = [0.0] }}\n{further}\n"
        )
    };
    let slides = "[sliding]\nv_mps = 11.0\nice_c = -2.0\n";
    for (sliding, further, reported) in [
        (
            "",
            "v_mps = { values = [5.0] }",
            &["table.toml", "no [sliding]"][..],
        ),
        (
            slides,
            "v_mps = { values = [5.0, 500.0] }",
            &["axes.v_mps", "500"],
        ),
        (
            slides,
            "v_mps = { values = [5.0, -5.0] }",
            &["line 5", "v_mps", "-5", "positive"],
        ),
        (
            slides,
            "ice_c = { from = -5.0, to = 1.0 }",
            &["axes.ice_c", "sliding.ice_c = 1"],
        ),
        (
            slides,
            "ice_c = 4",
            &["line 5", "found `4`, expected a table"],
        ),
        (
            slides,
            "rocker_radius_m = { values = [0.01, 30.0] }",
            &[
                "table.toml: axes.rocker_radius_m = 0.01: ",
                "expected a radius",
            ],
        ),
    ] {
        let bench = bench(sliding, &axes(further));
        let output = bench.kufe(&["lut", "table.toml", "-o", "front.lut"]);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{printed}");
        for word in reported {
            assert!(printed.contains(word), "{further}: {word}: {printed}");
        }
    }
}
