//! Hardness by its laws, how friction follows, and the plastic depth in the VTU file.

use kufe_outside::python;
use serde_json::Value;

use crate::kufe::{Bench, json, refused, succeeds};

/// A sharp runner at 20 m/s on ice of -5 C; `ice` in the table `[ice]`, `sliding` in `[sliding]`.
fn case(ice: &str, sliding: &str) -> String {
    format!(
        "[runner]\nshape = {{ kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.004, width_m = 0.008, height_m = 0.030 }}\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n{ice}\n\
         [load]\nfz_n = 950.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.02\n[sliding]\nv_mps = 20.0\nice_c = -5.0\n{sliding}\n"
    )
}

const ANCHOR: &str = "hardness = { pressure_pa = 17.7e6, ice_c = -5.0, contact_time_s = 2.0e-3 }";

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap_or_else(|| panic!("no {key}"))
}

fn pressed(bench: &Bench, text: String) -> Value {
    bench.write("case.toml", text);
    bench.succeeds(&["press", "case.toml", "-o", "out"]);
    json(&bench.path("out/result.json"))
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn the_hardness_is_that_of_the_law_which_result_json_names() {
    let bench = Bench::new();
    let at = |ice: &str, sliding: &str| {
        let result = pressed(&bench, case(ice, sliding));
        let length = number(&result, "front_m") - number(&result, "back_m");
        let time = number(&result, "contact_time_s");
        assert!((time * 20.0 / length - 1.0).abs() < 1e-12);
        let from = result["hardness_from"].as_str().expect("a law").to_owned();
        (number(&result, "hardness_pa"), time, from)
    };
    let (hardness, _, from) = at("", "");
    assert_eq!((hardness, &from[..]), (17.7e6, "temperature-law"));
    let (hardness, _, from) = at("hardness_pa = 30e6", "");
    assert_eq!((hardness, &from[..]), (30e6, "given"));
    // Ice of 30 MPa melts at 5 K/(0.074 K/MPa) = 67.6 MPa, at -1 C at 13.5 MPa.
    let warm = case("hardness_pa = 30e6", "").replace("ice_c = -5.0", "ice_c = -1.0");
    let result = pressed(&bench, warm);
    assert_eq!(result["hardness_from"], "melting");
    assert!((number(&result, "hardness_pa") / (1.0 / 7.4e-8) - 1.0).abs() < 1e-12);
    // At the anchor's temperature creep gives H = 17.7 MPa (t/2 ms)^(-1/3), within the tolerance of the search: a quarter of the accuracy.
    let (hardness, time, from) = at("", ANCHOR);
    assert_eq!(from, "time-law");
    let creep = 17.7e6 * (time / 2.0e-3).powf(-1.0 / 3.0);
    assert!(
        (hardness / creep - 1.0).abs() < 5.1e-3,
        "{hardness} {creep}"
    );
    for (ice, sliding) in [
        ("", ANCHOR.replace("2.0e-3", "0.0")),
        ("hardness_pa = 30e6", ANCHOR.to_owned()),
        (
            "",
            format!("{ANCHOR}\n[effects.hardness]\ninverse_per_pa = 1e-8"),
        ),
    ] {
        bench.write("case.toml", case(ice, &sliding));
        let reported = ["case.toml", "sliding.hardness"];
        refused(bench.folder.path(), &["press", "case.toml"], 3, &reported);
    }
}

/// mu of each point, its error's share of it some half a per cent.
fn friction(bench: &Bench, text: String, speed: &str, ice: &str) -> Vec<f64> {
    bench.write("runs.toml", text);
    let words = [
        "friction",
        "runs.toml",
        "--groove",
        "--v-mps",
        speed,
        "--ice-c",
        ice,
        "--json",
    ];
    let reported: Value =
        serde_json::from_str(&succeeds(bench.folder.path(), &words)).expect("JSON");
    let points = reported["points"].as_array().expect("points");
    points.iter().map(|point| number(point, "mu")).collect()
}

/// Whole runs to either side, whose meshes differ: what they scatter by, some 3e-3 of mu, over the step is the tolerance.
#[test]
#[ignore = "slow study: .ci/slow"]
fn friction_follows_as_differences_of_whole_runs_say() {
    let bench = Bench::new();
    for law in ["", ANCHOR] {
        let result = pressed(&bench, case("", law));
        let reported = |key: &str| number(&result["mu_sensitivity"], key);
        let slope = |mu: &[f64], step: f64| (mu[0] / mu[1]).ln() / step;
        let speed = friction(&bench, case("", law), "25,16", "-5");
        let found = slope(&speed, (25.0f64 / 16.0).ln());
        assert!(
            (found - reported("dlnmu_dlnv")).abs() < 0.02,
            "{found} {result}"
        );
        let ice = friction(&bench, case("", law), "20", "-4,-6");
        let found = slope(&ice, 2.0);
        assert!(
            (found - reported("dlnmu_dice_c")).abs() < 0.004,
            "{found} {result}"
        );
        if law == ANCHOR {
            // Viscosity and a stated hardness do not use the law.
            continue;
        }
        let thick = |factor: &str| {
            let factor = format!("viscosity_factor = {factor}");
            friction(&bench, case("", &factor), "20", "-5")[0]
        };
        let found = slope(&[thick("1.25"), thick("0.8")], (1.25f64 / 0.8).ln());
        assert!(
            (found - reported("dlnmu_dlnviscosity")).abs() < 0.02,
            "{found} {result}"
        );
        let hard = |factor: f64| {
            let hardness = format!("hardness_pa = {}", factor * number(&result, "hardness_pa"));
            friction(&bench, case(&hardness, ""), "20", "-5")[0]
        };
        let found = slope(&[hard(1.2), hard(1.0 / 1.2)], 1.2f64.powi(2).ln());
        let error = reported("dlnmu_dlnhardness_error");
        assert!(error < 0.1, "{error}");
        assert!(
            (found - reported("dlnmu_dlnhardness")).abs() < 0.03,
            "{found} {result}"
        );
    }
}

/// Roughness and boundary shear: parts, shares, sensitivities, and a table's point with all of them.
#[test]
fn boundary_contact_adds_its_part_to_friction_and_its_share_to_the_film() {
    let bench = Bench::new();
    let rough =
        |sigma: f64, shear: f64| format!("roughness_m = {sigma:e}\nboundary_shear_pa = {shear:e}");
    let alone = pressed(&bench, case("", ""));
    let smooth = pressed(&bench, case("", &rough(0.0, 60e3)));
    for key in ["mu", "mu_viscous", "film_mean_m", "melt_rate_kgps"] {
        assert_eq!(alone[key], smooth[key], "{key}");
    }
    assert_eq!(number(&smooth, "mu_boundary"), 0.0);
    assert!(smooth["mu_sensitivity"].get("dlnmu_dlnroughness").is_none());

    let both = pressed(&bench, case("", &rough(0.5e-6, 60e3)));
    let part = |key: &str| number(&both, key);
    let sum = part("mu_ploughing") + part("mu_viscous") + part("mu_boundary");
    assert!((part("mu") / sum - 1.0).abs() < 1e-12);
    assert_eq!(
        number(&both, "mu_ploughing"),
        number(&alone, "mu_ploughing")
    );
    assert!(part("mu_boundary") > 0.0 && part("mu_viscous") < number(&alone, "mu_viscous"));
    assert!(part("film_mean_m") > number(&alone, "film_mean_m"));
    // Every touching part of the patch drags with the same stress.
    let drag = 60e3 * part("boundary_share") * part("area_m2");
    let found = part("mu_boundary") * part("fz_n");
    assert!((found / drag - 1.0).abs() < 0.05, "{found} {drag}");

    let slope = |mu: [f64; 2]| (mu[0] / mu[1]).ln() / 1.25f64.powi(2).ln();
    let at =
        |sigma: f64, shear: f64| friction(&bench, case("", &rough(sigma, shear)), "20", "-5")[0];
    let by = &both["mu_sensitivity"];
    let roughness = slope([at(0.625e-6, 60e3), at(0.4e-6, 60e3)]);
    let reported = number(by, "dlnmu_dlnroughness");
    assert!(
        (roughness - reported).abs() < 0.02,
        "{roughness} {reported}"
    );
    let shear = slope([at(0.5e-6, 75e3), at(0.5e-6, 48e3)]);
    let reported = number(by, "dlnmu_dlnboundary_shear");
    assert!((shear - reported).abs() < 0.02, "{shear} {reported}");
}

#[test]
fn the_plastic_depth_in_the_vtu_file_is_the_groove() {
    let bench = Bench::new();
    let result = pressed(&bench, case("", ""));
    let Some(interpreter) = python("pyvista") else {
        return;
    };
    let script = "import sys, json, numpy as np, pyvista\n\
        m = pyvista.read(sys.argv[1])\n\
        d, z = m.point_data['plastic_depth_m'], m.points[:, 2]\n\
        top = z == z.max()\n\
        x = m.points[:, 0]\n\
        left = d[top & (x == x.min())]\n\
        print(json.dumps([float(d[top].max()), float(np.abs(d[~top]).max()), float(left.max()), float(d[top & (x == x.max())].max())]))";
    let output = std::process::Command::new(interpreter)
        .args(["-c", script])
        .arg(bench.path("out/field.vtu"))
        .output()
        .expect("python runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let found: Vec<f64> = serde_json::from_slice(&output.stdout).expect("numbers");
    // Deepest on the surface and behind the contact; none below, none ahead. VTU has the values of the solver's last mesh, in single precision.
    let depth = number(&result, "groove_depth_m");
    assert!(
        (found[0] / depth - 1.0).abs() < 1e-7 && found[2] == found[0],
        "{found:?} {depth}"
    );
    assert_eq!((found[1], found[3]), (0.0, 0.0));
}
