//! Hulls that `kufe hull` makes, pressed: of a rocker given as points, and of steel that bends.

use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, json};
use crate::press::elastic::{case, number, result};

/// Points of an arc of `radius` [m].
fn arc(radius: f64) -> String {
    let points = (-20..=20).map(|i| {
        let x = 0.025 * f64::from(i);
        format!("{x},{}\n", radius - (radius * radius - x * x).sqrt())
    });
    format!("x_m,z_m\n{}", points.collect::<String>())
}

#[test]
fn points_of_an_arc_make_the_hull_of_that_rocker_radius() {
    let bench = Bench::new();
    bench.write("rocker.csv", arc(20.0));
    bench.succeeds(&[
        "hull",
        "bob",
        "--edge-length-m",
        "0.002",
        "--rocker-points",
        "rocker.csv",
        "-o",
        "points.obj",
    ]);
    bench.succeeds(&[
        "hull",
        "bob",
        "--edge-length-m",
        "0.002",
        "--rocker-radius-m",
        "20",
        "-o",
        "radius.obj",
    ]);
    let heights = |name: &str| -> Vec<f64> {
        let text = std::fs::read_to_string(bench.path(name)).expect("a hull");
        text.lines()
            .filter(|line| line.starts_with("v "))
            .map(|line| {
                line.split_whitespace()
                    .nth(3)
                    .expect("z")
                    .parse()
                    .expect("a number")
            })
            .collect()
    };
    let (points, radius) = (heights("points.obj"), heights("radius.obj"));
    assert_eq!(points.len(), radius.len());
    let worst = points
        .iter()
        .zip(&radius)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-7, "{worst:e} m apart");
}

#[test]
fn a_rocker_with_a_word_in_it_is_named_with_its_row() {
    let bench = Bench::new();
    bench.write("rocker.csv", "x_m,z_m\n-0.5,0.004\n0,low\n0.5,0.004\n");
    let output = bench.kufe(&[
        "hull",
        "bob",
        "--rocker-points",
        "rocker.csv",
        "-o",
        "a.obj",
    ]);
    assert_eq!(output.status.code(), Some(3));
    let printed = errors(&output);
    assert!(
        printed.contains("row 3") && printed.contains("z_m") && printed.contains("low"),
        "{printed}"
    );
    assert!(!bench.path("a.obj").exists());
}

/// What a runner of a shape answers, and the same written as triangles of two sizes and filled up to its top.
fn hulls_answer_as_their_shape(shape: &str, written: &[&str], load: [f64; 2], lengths: [&str; 2]) {
    let bench = Bench::new();
    let [fz, accuracy] = load;
    let case = |runner: &str| {
        format!(
            "[runner]\n{runner}\nelastic = true\nmount = {{ held = [{{ x_m = -0.08, length_m = 0.012 }}, {{ x_m = 0.08, length_m = 0.012 }}] }}\n\
             [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\
             [load]\nfz_n = {fz:?}\ntilt = \"fixed\"\n[accuracy]\np_max = {accuracy:?}\n"
        )
    };
    let answer = |runner: &str| {
        bench.write("case.toml", case(runner));
        bench.succeeds(&["press", "case.toml"]);
        assert!(bench.path("out/runner.vtu").is_file());
        result(&bench)
    };
    let own = answer(&format!("shape = {{ {shape} }}"));
    for length in lengths {
        let file = ["-o", "hull.stl", "--force", "--edge-length-m", length];
        bench.succeeds(&[&["hull"], written, &file].concat());
        let hull = answer("hull = \"hull.stl\"");
        for key in ["p_max", "approach"] {
            let unit = if key == "p_max" { "pa" } else { "m" };
            let [of_shape, of_hull] = [&own, &hull].map(|r| {
                let error = number(r, &format!("{key}_error_{unit}"));
                (number(r, &format!("{key}_{unit}")), error)
            });
            println!("{length} {key}: {of_shape:?} {of_hull:?}");
            let apart = (of_shape.0 - of_hull.0).abs();
            assert!(apart < of_shape.1 + of_hull.1, "{length} {key}: {apart}");
        }
        let mounts = |r: &Value| r["mounts"].as_array().expect("mounts").clone();
        let (of_shape, of_hull) = (mounts(&own), mounts(&hull));
        assert_eq!((of_shape.len(), of_hull.len()), (2, 2));
        for (a, b) in of_shape.iter().zip(&of_hull) {
            println!("{a} {b}");
            // Forces and moments are of the last meshes, whose peaks part by as much; the largest of each counts.
            for (key, axis, share) in [
                ("force_n", 0, 0.03),
                ("force_n", 2, 1e-6),
                ("moment_nm", 1, 0.02),
            ] {
                let [a, b] = [a, b].map(|m| m[key][axis].as_f64().expect("a number"));
                assert!(
                    (b / a - 1.0).abs() < share,
                    "{length} {key} {axis}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn a_bobsled_runner_as_triangles_bends_as_its_shape_does() {
    hulls_answer_as_their_shape(
        "kind = \"bob\", length_m = 0.3, rocker_radius_m = 8.0, section_radius_m = 0.004, width_m = 0.008, height_m = 0.012",
        &[
            "bob",
            "--length-m",
            "0.3",
            "--rocker-radius-m",
            "8",
            "--section-radius-m",
            "0.004",
            "--width-m",
            "0.008",
            "--height-m",
            "0.012",
        ],
        [400.0, 0.03],
        ["0.0005", "0.001"],
    );
}

#[test]
fn a_luge_steel_as_triangles_bends_as_its_shape_does() {
    hulls_answer_as_their_shape(
        "kind = \"luge\", length_m = 0.3, rocker_radius_m = 25.0, edge_radius_m = 0.3e-3, tilt_rad = 0.02, width_m = 0.020, height_m = 0.008",
        &["luge", "--length-m", "0.3"],
        [400.0, 0.05],
        ["0.0005", "0.001"],
    );
}

/// An open hull states where its top is; a hull that columns cannot fill is refused, with the file, the figure and what is expected.
#[test]
fn elastic_hulls_that_cannot_be_filled_are_refused_with_the_way_out() {
    let bench = Bench::new();
    bench.succeeds(&[
        "hull",
        "bob",
        "--length-m",
        "0.3",
        "--edge-length-m",
        "0.001",
        "-o",
        "bob.obj",
    ]);
    let text = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
    let heights: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("v ")?.split(' ').nth(2)?.parse().ok())
        .collect();
    // Without the facets of its top.
    let open = text.lines().filter(|line| match line.strip_prefix("f ") {
        Some(corners) => {
            let corners = corners
                .split(' ')
                .map(|c| c.parse::<usize>().expect("a corner"));
            corners.map(|c| heights[c - 1]).any(|z| z < 0.0299)
        }
        None => true,
    });
    bench.write(
        "open.obj",
        open.map(|line| format!("{line}\n")).collect::<String>(),
    );
    // The upper half of its sides moved inwards.
    let undercut = text.lines().map(|line| {
        let words: Vec<&str> = line.split(' ').collect();
        match words[..] {
            ["v", x, y, z] if z.parse::<f64>().expect("a height") > 0.02 => {
                format!("v {x} {} {z}\n", 0.5 * y.parse::<f64>().expect("a place"))
            }
            _ => format!("{line}\n"),
        }
    });
    bench.write("undercut.obj", undercut.collect::<String>());
    let press = |hull: &str, more: &str| {
        let case = case(more, "fixed");
        let shape = case.lines().nth(1).expect("the shape's line").to_owned();
        let case = case.replace(&shape, &format!("hull = \"{hull}\""));
        bench.write("case.toml", case.replace("fz_n = 500.0", "fz_n = 1000.0"));
        bench.kufe(&["press", "case.toml", "-o", "out"])
    };
    for (hull, more, expected) in [
        (
            "open.obj",
            "",
            &["open.obj: the hull is open", "expected runner.height_m"],
        ),
        (
            "undercut.obj",
            "",
            &[
                "undercut.obj: ",
                "undercuts, holes, or a top that is not flat",
            ],
        ),
        (
            "bob.obj",
            "height_m = 0.05",
            &["bob.obj: ", "top at 0.0500 m"],
        ),
        (
            "bob.obj",
            "height_m = 5.0",
            &["runner.height_m = 5: expected a height in metres", "line "],
        ),
    ] {
        let output = press(hull, more);
        let printed = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{printed}");
        assert!(
            expected.iter().all(|part| printed.contains(part)),
            "{printed}"
        );
        assert!(!bench.path("out").exists(), "{printed}");
    }
    let peaks = [("bob.obj", ""), ("open.obj", "height_m = 0.03")].map(|(hull, more)| {
        let output = press(hull, more);
        assert!(output.status.success(), "{}", errors(&output));
        number(&result(&bench), "p_max_pa")
    });
    assert!((peaks[0] / peaks[1] - 1.0).abs() < 1e-3, "{peaks:?}");
}

/// The outline of a bobsled runner narrowed towards its ends: its keel remains a Hertz contact if its triangles are fine enough, and a hull
/// on which no mesh converges is reported as such.
#[test]
fn a_tapered_outline_presses_as_its_keel_or_has_an_unknown_error() {
    let bench = Bench::new();
    let tapered = |edge: &str, narrowed: &dyn Fn(f64) -> f64| {
        bench.succeeds(&[
            "hull",
            "bob",
            "-o",
            "bob.obj",
            "--force",
            "--edge-length-m",
            edge,
        ]);
        let text = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
        let line = |line: &str| match line.strip_prefix("v ") {
            None => format!("{line}\n"),
            Some(place) => {
                let place: Vec<f64> = place
                    .split(' ')
                    .map(|n| n.parse().expect("a number"))
                    .collect();
                let y = place[1] * (1.0 - narrowed(place[0] / 0.5));
                format!("v {} {y} {}\n", place[0], place[2])
            }
        };
        bench.write("tapered.obj", text.lines().map(line).collect::<String>());
        let shape = CASE.lines().nth(1).expect("a shape");
        bench.write("case.toml", CASE.replace(shape, "hull = \"tapered.obj\""));
        bench.kufe(&["press", "case.toml", "-o", "out"])
    };
    let output = tapered("0.0005", &|x| 0.2 * x * x);
    assert!(output.status.success(), "{}", errors(&output));
    let result = json(&bench.path("out/result.json"));
    let figure = |key: &str| result[key].as_f64().expect("a number");
    let off = (figure("p_max_pa") - 138.52e6).abs();
    assert!(
        off < figure("p_max_error_pa") + figure("p_max_hull_pa"),
        "{result}"
    );
    let output = tapered("0.002", &|x| if x > 0.0 { 0.6 * x } else { -0.3 * x });
    let reported = errors(&output);
    assert_eq!(output.status.code(), Some(4), "{reported}");
    assert!(
        reported.contains("vertices closer together lower that"),
        "{reported}"
    );
    let result = json(&bench.path("out/result.json"));
    let figure = |key: &str| result[key].as_f64().expect("a number");
    assert!(figure("p_max_hull_pa") > figure("p_max_pa"), "{result}");
}
