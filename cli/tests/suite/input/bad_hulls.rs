//! Hulls that are no hulls, or not the hull that was meant, through `kufe press`.

use std::process::Output;

use crate::kufe::{Bench, CASE, errors};

/// The case with this hull in the shape's place.
fn case_of(hull: &str) -> String {
    let shape = CASE.lines().nth(1).expect("the shape's line");
    CASE.replacen(shape, hull, 1)
        .replace("p_max = 0.02", "p_max = 0.01")
}

/// A folder with a bobsled runner as an OBJ file.
fn bench_with_hull() -> (Bench, String) {
    let bench = Bench::new();
    bench.succeeds(&["hull", "bob", "--edge-length-m", "0.001", "-o", "bob.obj"]);
    let text = std::fs::read_to_string(bench.path("bob.obj")).expect("a hull");
    (bench, text)
}

fn press(bench: &Bench, hull: &str) -> Output {
    bench.write("case.toml", case_of(hull));
    bench.kufe(&["press", "case.toml", "-o", "out", "--json"])
}

/// Exit code 3, one line with the word `expected`, and no output folder.
fn refused(bench: &Bench, hull: &str, expected: &[&str]) {
    let output = press(bench, hull);
    let printed = errors(&output);
    let lines = printed.lines().filter(|line| !line.contains("warning:"));
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert_eq!(lines.count(), 1, "one line: {printed}");
    for part in expected {
        assert!(printed.contains(part), "{part:?} is missing: {printed}");
    }
    assert!(output.stdout.is_empty());
    assert!(!bench.path("out").exists(), "a file remains");
    assert!(
        bench.names().iter().all(|name| !name.starts_with('.')),
        "{:?}",
        bench.names()
    );
}

/// The peak, also if the vertices determine it less accurately than requested.
fn p_max(output: &Output) -> f64 {
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 4)), "{}", errors(output));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    result["p_max_pa"].as_f64().expect("a peak")
}

/// The OBJ text with each line changed, or dropped.
fn lines(text: &str, change: impl Fn(&str) -> Option<String>) -> String {
    text.lines()
        .filter_map(change)
        .map(|line| line + "\n")
        .collect()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace()
        .skip(1)
        .map(|word| word.parse().expect("a number"))
        .collect()
}

#[test]
fn a_tessellated_hull_gives_the_parametric_peak() {
    let (bench, _) = bench_with_hull();
    bench.succeeds(&["hull", "bob", "--edge-length-m", "0.0005", "-o", "fine.obj"]);
    bench.write("shape.toml", CASE.replace("p_max = 0.02", "p_max = 0.01"));
    let parametric = p_max(&bench.kufe(&["press", "shape.toml", "-o", "shape", "--json"]));
    for hull in ["bob.obj", "fine.obj"] {
        let read = p_max(&press(&bench, &format!("hull = \"{hull}\"")));
        assert!(
            (read / parametric - 1.0).abs() < 0.02,
            "{hull}: {read} against {parametric}"
        );
    }
}

/// STEP and IGES have no triangles: the error names a command that makes some.
#[test]
fn exact_shapes_are_refused_with_the_command_that_makes_triangles_of_them() {
    let bench = Bench::new();
    for name in ["bob.step", "bob.STP", "bob.iges", "bob.igs"] {
        bench.write(name, "ISO-10303-21;\n");
        let command = format!("`gmsh ./{name} -2 -clmax 0.5 -format stl -bin -o ./bob.stl`");
        refused(
            &bench,
            &format!("hull = \"./{name}\""),
            &[
                "runner.hull: ",
                name,
                "expected obj, gltf, glb, stl or 3mf",
                &command,
                "scale = 0.001",
            ],
        );
        let output = bench.kufe(&["hull", "check", name]);
        assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
        assert!(errors(&output).contains("gmsh bob"), "{}", errors(&output));
    }
}

/// A steel on an edge of 0.3 mm, which facets must turn by little to follow.
#[test]
fn a_luge_hull_of_the_defaults_gives_the_parametric_peak() {
    let bench = Bench::new();
    bench.succeeds(&["hull", "luge", "-o", "luge.obj"]);
    let shape = "shape = { kind = \"luge\", length_m = 0.6, rocker_radius_m = 25.0, edge_radius_m = 3e-4, tilt_rad = 0.02, \
                 width_m = 0.02, height_m = 0.008 }";
    let light = |runner: &str| {
        let case = case_of(runner).replace("fz_n = 1000.0", "fz_n = 500.0");
        bench.write("light.toml", case);
        p_max(&bench.kufe(&["press", "light.toml", "-o", "out", "--json"]))
    };
    let parametric = light(shape);
    let read = || light("hull = \"luge.obj\"");
    // Edges of 5 mm ask for finer cells than the unknowns leave room for: a coarser mesh of the finer grading tells that these change
    // nothing.
    let coarse = ["--edge-length-m", "0.005", "-o", "luge.obj", "--force"];
    let mut peaks = vec![read()];
    bench.succeeds(&[&["hull", "luge"][..], &coarse].concat());
    peaks.push(read());
    for read in peaks {
        assert!(
            (read / parametric - 1.0).abs() < 0.02,
            "{read} against {parametric}"
        );
    }
}

#[test]
fn an_inverted_hull_is_refused_with_the_fix() {
    let (bench, text) = bench_with_hull();
    let inverted = lines(&text, |line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["f", a, b, c] => Some(format!("f {a} {c} {b}")),
            _ => Some(line.into()),
        }
    });
    bench.write("inverted.obj", inverted);
    refused(
        &bench,
        "hull = \"inverted.obj\"",
        &["case.toml: ", "inverted.obj: ", "face inwards", "reverse"],
    );
}

#[test]
fn a_hull_without_triangles_is_refused() {
    let (bench, text) = bench_with_hull();
    bench.write(
        "points.obj",
        lines(&text, |line| {
            (!line.starts_with('f')).then(|| line.to_string())
        }),
    );
    bench.write("empty.obj", "");
    bench.write("empty.stl", [0; 84]);
    for hull in ["points.obj", "empty.obj", "empty.stl"] {
        refused(
            &bench,
            &format!("hull = \"{hull}\""),
            &[hull, "no triangles"],
        );
    }
}

#[test]
fn a_hull_in_a_cases_place_is_refused_with_the_command_that_writes_its_case() {
    let (bench, _) = bench_with_hull();
    let output = bench.kufe(&["press", "bob.obj", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3));
    let expected = "bob.obj: this is a hull, expected a case: kufe hull check bob.obj -o case.toml";
    assert!(errors(&output).contains(expected), "{}", errors(&output));
}

#[test]
fn a_hull_that_is_not_there_or_of_an_unknown_kind_is_named() {
    let bench = Bench::new();
    refused(&bench, "hull = \"nowhere.obj\"", &["nowhere.obj"]);
    bench.write("hull.step", "ISO-10303-21;");
    refused(&bench, "hull = \"hull.step\"", &["hull.step", "expected"]);
}

#[test]
fn gltf_sizes_that_are_lies_are_refused_with_both_sizes() {
    let bench = Bench::new();
    bench.succeeds(&["hull", "bob", "--edge-length-m", "0.01", "-o", "bob.glb"]);
    let honest = std::fs::read(bench.path("bob.glb")).expect("a hull");
    let mut header = honest.clone();
    header[8..12].copy_from_slice(&0x7fff_ffff_u32.to_le_bytes());
    bench.write("header.glb", header);
    let has = format!("the file has {}", honest.len());
    refused(
        &bench,
        "hull = \"header.glb\"",
        &["header.glb: ", "2147483647 bytes", &has],
    );
    let key = b"\"buffers\":[{\"byteLength\":";
    let start = key.len()
        + honest
            .windows(key.len())
            .position(|window| window == key)
            .expect("a buffer's length");
    let digits = honest[start..]
        .iter()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    let mut buffer = honest.clone();
    buffer[start..start + digits].fill(b'9');
    bench.write("buffer.glb", buffer);
    let announced = format!("buffer 0 announces {} bytes", "9".repeat(digits));
    refused(
        &bench,
        "hull = \"buffer.glb\"",
        &["buffer.glb: ", &announced, "it has"],
    );
    bench.write("half.glb", &honest[..honest.len() / 2]);
    refused(&bench, "hull = \"half.glb\"", &["half.glb: "]);
}

#[test]
fn millimetres_read_as_metres_are_refused_with_the_fix_and_the_fix_works() {
    let (bench, text) = bench_with_hull();
    let millimetres = lines(&text, |line| {
        if !line.starts_with("v ") {
            return Some(line.into());
        }
        let [x, y, z] = numbers(line)[..] else {
            panic!("{line}")
        };
        Some(format!("v {} {} {}", 1e3 * x, 1e3 * y, 1e3 * z))
    });
    bench.write("mm.obj", millimetres);
    let output = press(&bench, "hull = \"mm.obj\"");
    assert!(
        errors(&output).contains("scale = 0.001"),
        "{}",
        errors(&output)
    );
    let metres = p_max(&press(&bench, "hull = \"bob.obj\""));
    let output = press(&bench, "hull = \"mm.obj\"\nscale = 0.001");
    assert!(!errors(&output).contains("scale"), "{}", errors(&output));
    let scaled = p_max(&output);
    assert!(
        (scaled / metres - 1.0).abs() < 2e-3,
        "{scaled} against {metres}"
    );
}

#[test]
fn an_open_hull_is_reported_and_its_underside_used() {
    let (bench, text) = bench_with_hull();
    let heights: Vec<f64> = text
        .lines()
        .filter(|line| line.starts_with("v "))
        .map(|line| numbers(line)[2])
        .collect();
    let top = heights.iter().copied().fold(f64::MIN, f64::max);
    let on_top = |line: &str| {
        numbers(line)
            .iter()
            .all(|&index| heights[index as usize - 1] > top - 1e-9)
    };
    bench.write(
        "open.obj",
        lines(&text, |line| {
            (!line.starts_with("f ") || !on_top(line)).then(|| line.to_string())
        }),
    );
    let closed = p_max(&press(&bench, "hull = \"bob.obj\""));
    let output = press(&bench, "hull = \"open.obj\"");
    assert!(
        errors(&output).contains("the hull is open: "),
        "{}",
        errors(&output)
    );
    let open = p_max(&output);
    assert!(
        (open / closed - 1.0).abs() < 2e-3,
        "{open} against {closed}"
    );
}

/// A rocker of 30 m and a section of 5 mm with a vertex every 2 mm across: sampled too thinly for 12 µm of approach.
fn coarse_hull() -> String {
    let (stations, across) = (9, 5);
    let mut text = String::new();
    for i in 0..stations {
        for j in 0..across {
            let x = -0.5 + f64::from(i) / f64::from(stations - 1);
            let y = -0.004 + 0.008 * f64::from(j) / f64::from(across - 1);
            let z = x * x / 60.0 + 0.005 - (0.005_f64.powi(2) - y * y).sqrt();
            text += &format!("v {x} {y} {z}\n");
        }
    }
    for i in 0..stations - 1 {
        for j in 0..across - 1 {
            let a = i * across + j + 1;
            let [b, c, d] = [a + 1, a + across, a + across + 1];
            text += &format!("f {a} {b} {d}\nf {a} {d} {c}\n");
        }
    }
    text
}

/// `press` states it as an error; `friction` has none.
#[test]
fn a_hull_too_coarse_for_its_load_is_answered_with_its_error_or_refused_with_the_numbers() {
    let bench = Bench::new();
    bench.write("coarse.obj", coarse_hull());
    let pressed = press(&bench, "hull = \"coarse.obj\"");
    let printed = errors(&pressed);
    assert_eq!(pressed.status.code(), Some(4), "{printed}");
    for part in ["leave the peak uncertain by", "strips of 125 mm"] {
        assert!(printed.contains(part), "{printed}");
    }
    let result: serde_json::Value = serde_json::from_slice(&pressed.stdout).expect("JSON");
    let stated = ["p_max_error_pa", "p_max_hull_pa", "p_max_noise_pa"]
        .map(|key| result[key].as_f64().unwrap_or(0.0));
    // Hertz: 138.5 MPa on a half-space, a layer of 50 mm within 1 %.
    let off = (result["p_max_pa"].as_f64().expect("a peak") - 138.5e6).abs();
    assert!(
        off <= stated.iter().sum::<f64>() + 1.4e6,
        "{off} {stated:?}"
    );
    let output = bench.kufe(&["friction", "case.toml", "--v-mps", "30"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    let expected = [
        "runner.hull: too coarse",
        "uncertain by ",
        "µm, the ice is pressed in by ",
    ];
    for part in expected {
        assert!(errors(&output).contains(part), "{}", errors(&output));
    }
}

#[test]
fn a_stray_vertex_is_refused_and_a_second_runner_and_one_across_are_reported() {
    let (bench, hull) = bench_with_hull();
    let moved = |line: &str, to: &dyn Fn(&[f64]) -> [f64; 3]| {
        if !line.starts_with("v ") {
            return line.to_owned();
        }
        let [x, y, z] = to(&numbers(line));
        format!("v {x} {y} {z}")
    };
    let down = lines(&hull, |line| {
        let to = |at: &[f64]| match at {
            [0.0, 0.0, 0.0] => [0.0, 0.0, -1.0],
            at => [at[0], at[1], at[2]],
        };
        Some(moved(line, &to))
    });
    assert_ne!(down, hull);
    bench.write("down.obj", down);
    refused(
        &bench,
        "hull = \"down.obj\"",
        &["lowest vertex", "z = -1.000000", "stray"],
    );
    let count = hull.lines().filter(|line| line.starts_with("v ")).count();
    let second = lines(&hull, |line| {
        let Some(corners) = line.strip_prefix("f ") else {
            return Some(moved(line, &|at| [at[0], at[1] + 0.4, at[2]]));
        };
        let corners = corners.split(' ').map(|word| {
            let number = word.split('/').next().and_then(|n| n.parse::<usize>().ok());
            format!(" {}", number.expect("a number") + count)
        });
        Some(format!("f{}", corners.collect::<String>()))
    });
    bench.write("two.obj", format!("{hull}{second}"));
    let across = lines(&hull, |line| {
        Some(moved(line, &|at| [-at[1], at[0], at[2]]))
    });
    bench.write("across.obj", across);
    let whole = p_max(&press(&bench, "hull = \"bob.obj\""));
    for (file, part) in [
        ("two.obj", "2 bodies apart"),
        ("across.obj", "expected `forward`"),
    ] {
        let output = press(&bench, &format!("hull = \"{file}\""));
        assert!(
            errors(&output).contains(part),
            "{file}: {}",
            errors(&output)
        );
        assert!((p_max(&output) / whole - 1.0).abs() < 0.02, "{file}");
    }
    let turned = press(&bench, "hull = \"across.obj\"\nforward = \"y\"");
    assert!(!errors(&turned).contains("forward"), "{}", errors(&turned));
}

#[test]
fn a_load_that_misses_a_hull_is_refused_with_both_places() {
    let (bench, _) = bench_with_hull();
    let case =
        case_of("hull = \"bob.obj\"").replace("fz_n = 1000.0", "fz_n = 1000.0\noffset_y_m = 0.1");
    bench.write("case.toml", case);
    let output = bench.kufe(&["press", "case.toml", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(
        errors(&output).contains("y = 0.1000 m misses the hull, which spans"),
        "{}",
        errors(&output)
    );
    assert!(!bench.path("out").exists());
}
