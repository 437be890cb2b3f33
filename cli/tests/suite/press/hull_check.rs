//! `kufe hull check`: how a scanned hull stands, how noisy it is, and which loads it resolves.

use serde_json::Value;

use crate::kufe::{Bench, CASE, json, refused};

/// A number in [0, 1) from a counter (D. Lehmer's generator modulo 2^31 - 1).
fn random(state: &mut u64) -> f64 {
    *state = *state * 48_271 % 2_147_483_647;
    *state as f64 / 2_147_483_647.0
}

/// A standard normal deviate: twelve uniform ones less six.
pub(super) fn normal(state: &mut u64) -> f64 {
    (0..12).map(|_| random(state)).sum::<f64>() - 6.0
}

/// The same OBJ with noise [m] on its vertices, which `place` then moves.
fn scanned(obj: &str, noise: f64, place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut state = 20_261_122;
    let line = |line: &str| match line.strip_prefix("v ") {
        Some(numbers) => {
            let mut p = [0.0; 3];
            for (value, text) in p.iter_mut().zip(numbers.split_whitespace()) {
                *value = text.parse::<f64>().expect("a number") + noise * normal(&mut state);
            }
            let [x, y, z] = place(p);
            format!("v {x} {y} {z}\n")
        }
        None => format!("{line}\n"),
    };
    obj.lines().map(line).collect()
}

fn checked(bench: &Bench, file: &str) -> Value {
    let text = bench.succeeds(&["hull", "check", file, "--json"]);
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} of {value}"))
}

#[test]
fn unit_axes_and_radii_of_a_turned_hull_are_told_and_its_case_presses_as_hertz_does() {
    let bench = Bench::new();
    bench.succeeds(&["hull", "bob", "--length-m", "0.5", "-o", "bob.obj"]);
    let obj = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
    // Millimetres, x forward -> y, z up -> -x: a right-handed turn takes y left to -z.
    // It lies off the file's origin, as scans do.
    let turned = scanned(&obj, 0.0, |[x, y, z]| {
        [12.0 - 1e3 * z, 345.0 + 1e3 * x, 67.0 - 1e3 * y]
    });
    bench.write("turned.obj", &turned);
    let found = checked(&bench, "turned.obj");
    assert_eq!([&found["up"], &found["forward"]], ["-x", "y"], "{found:#}");
    assert_eq!(number(&found, "scale"), 1e-3);
    assert!(
        (number(&found, "rocker_radius_m") / 30.0 - 1.0).abs() < 0.01,
        "{found:#}"
    );
    assert!(
        (number(&found, "section_radius_m") / 0.005 - 1.0).abs() < 0.01,
        "{found:#}"
    );
    assert_eq!(number(&found, "noise_m"), 0.0);
    assert!(
        (number(&found, "spacing_m") / 5e-4 - 1.0).abs() < 0.1,
        "{found:#}"
    );

    let middle = [0, 1].map(|axis| found["beyond_origin_m"][axis].as_f64().expect("a place"));
    assert!(
        (middle[0] - 0.345).abs() < 1e-3 && (middle[1] + 0.067).abs() < 1e-3,
        "{middle:?}"
    );

    // The case has the load that was asked of, and where several were the one nearest to 1 kN.
    bench.succeeds(&[
        "hull",
        "check",
        "turned.obj",
        "--fz-n",
        "2000",
        "-o",
        "heavy.toml",
    ]);
    let heavy = std::fs::read_to_string(bench.path("heavy.toml")).expect("a case");
    assert!(heavy.contains("\nfz_n = 2000.0\n"), "{heavy}");
    bench.succeeds(&["hull", "check", "turned.obj", "-o", "turned.toml"]);
    bench.succeeds(&["press", "turned.toml", "-o", "out"]);
    let text = std::fs::read_to_string(bench.path("out/result.json")).expect("a result");
    let result: Value = serde_json::from_str(&text).expect("JSON");
    // 138.5 MPa on a half-space; the layer of 50 mm and the fit of the hull are within 1 %, the accuracy asked is 1 %.
    let peak = number(&result, "p_max_pa");
    assert!((peak / 138.5e6 - 1.0).abs() < 0.02, "{peak}");
    let again = ["hull", "check", "turned.obj", "-o", "turned.toml"];
    refused(
        &bench.path("."),
        &again,
        3,
        &["turned.toml: exists already"],
    );
}

#[test]
fn noise_is_measured_and_the_noise_that_would_do_does() {
    let bench = Bench::new();
    let size = ["--length-m", "0.3", "--edge-length-m", "0.0003"];
    bench.succeeds(&[&["hull", "bob", "-o", "bob.obj"][..], &size].concat());
    let obj = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
    let noisy = |noise: f64| {
        let file = format!("{noise:e}.obj");
        bench.write(&file, scanned(&obj, noise, |p| p));
        checked(&bench, &file)
    };
    let found = noisy(20e-6);
    assert!(
        (number(&found, "noise_m") / 20e-6 - 1.0).abs() < 0.1,
        "{found:#}"
    );
    let load = &found["loads"][2];
    assert_eq!(load["resolved"], false, "{found:#}");
    let enough = number(load, "noise_that_would_do_m");
    assert!(enough > 0.5e-6 && enough < 20e-6, "{found:#}");
    // The error's estimate itself scatters: two thirds of the noise named.
    let quieter = noisy(0.67 * enough);
    assert_eq!(quieter["loads"][2]["resolved"], true, "{quieter:#}");
}

/// Beside the clean hull, whose answer has no noise.
#[test]
fn noise_that_the_case_does_not_state_is_found_and_in_the_error() {
    let bench = Bench::new();
    let size = ["--length-m", "0.3", "--edge-length-m", "0.0005"];
    bench.succeeds(&[&["hull", "bob", "-o", "bob.obj"][..], &size].concat());
    let obj = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
    let case = CASE.replace(CASE.lines().nth(1).expect("a shape"), "hull = \"bob.obj\"");
    bench.write("case.toml", case);
    let pressed = |noise: f64| {
        bench.write("bob.obj", scanned(&obj, noise, |p| p));
        let out = format!("{noise:e}");
        bench.succeeds(&["press", "case.toml", "-o", &out]);
        json(&bench.path(&out).join("result.json"))
    };
    let clean = pressed(0.0);
    assert!(clean["p_max_noise_pa"].is_null() && clean["approach_noise_m"].is_null());
    assert_eq!(number(&clean["hull_fit"], "noise_m"), 0.0);
    for noise in [1e-7, 3e-7] {
        let noisy = pressed(noise);
        let found = number(&noisy["hull_fit"], "noise_m") / noise;
        assert!((found - 1.0).abs() < 0.2, "{found}");
        let checked = number(&checked(&bench, "bob.obj"), "noise_m");
        assert_eq!(checked, number(&noisy["hull_fit"], "noise_m"));
        for (figure, unit) in [("p_max", "pa"), ("approach", "m")] {
            let [value, error, moved] = ["", "_error", "_noise"]
                .map(|part| number(&noisy, &format!("{figure}{part}_{unit}")));
            let truth = number(&clean, &format!("{figure}_{unit}"));
            let slack = number(&clean, &format!("{figure}_error_{unit}"));
            println!(
                "{noise:e} {figure}: {:.4} off, {:.4} told",
                value / truth - 1.0,
                (error + moved) / truth
            );
            assert!(
                (value - truth).abs() < error + moved + slack,
                "{noise} {figure}"
            );
        }
    }
}

/// A flat beside an edge of 0.3 mm: its curvature jumps inside the contact.
#[test]
fn what_the_vertices_of_a_luge_steel_leave_is_stated_at_three_lengths_of_its_edges() {
    let bench = Bench::new();
    let shape = "shape = { kind = \"luge\", length_m = 0.6, rocker_radius_m = 25.0, edge_radius_m = 0.3e-3, tilt_rad = 0.02, width_m = 0.020, \
                 height_m = 0.008 }";
    let pressed = |runner: &str, name: &str| {
        let ice = "[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05";
        let load = "[load]\nfz_n = 500.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.01";
        let file = format!("{name}.toml");
        bench.write(&file, format!("[runner]\n{runner}\n{ice}\n{load}\n"));
        bench.succeeds(&["press", &file, "-o", name]);
        json(&bench.path(name).join("result.json"))
    };
    let shape = pressed(shape, "shape");
    let (truth, slack) = (number(&shape, "p_max_pa"), number(&shape, "p_max_error_pa"));
    for edge in ["0.0005", "0.001", "0.002"] {
        let hull = format!("{edge}.obj");
        bench.succeeds(&["hull", "luge", "--edge-length-m", edge, "-o", &hull]);
        let result = pressed(&format!("hull = \"{hull}\""), edge);
        let part = |key: &str| result[key].as_f64().unwrap_or(0.0);
        let stated = part("p_max_error_pa") + part("p_max_hull_pa") + part("p_max_noise_pa");
        let off = (number(&result, "p_max_pa") - truth).abs();
        println!(
            "{edge}: {:.4} off, {:.4} stated",
            off / truth,
            stated / truth
        );
        assert!(off <= stated + slack, "{edge}: {off} {stated}");
        assert!(stated < 0.2 * truth, "{edge}: {stated}");
    }
}

#[test]
fn a_hull_without_a_rounded_side_is_refused() {
    let bench = Bench::new();
    let corners: Vec<String> = (0..8)
        .map(|k| {
            format!(
                "v {} {} {}",
                k & 1,
                0.1 * f64::from(k >> 1 & 1),
                0.1 * f64::from(k >> 2)
            )
        })
        .collect();
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    bench.write("box.obj", format!("{}\n{faces}", corners.join("\n")));
    let told = ["box.obj: no side of it is rounded"];
    refused(&bench.path("."), &["hull", "check", "box.obj"], 3, &told);
    let words = ["hull", "check", "box.obj", "--fz-n=-5"];
    refused(
        &bench.path("."),
        &words,
        2,
        &["--fz-n -5: expected positive forces"],
    );
}
