//! `kufe press` from a case to its files.

use kufe::results::ContactResult;
use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, names, octave};

fn result(bench: &Bench, folder: &str) -> Value {
    let text = std::fs::read_to_string(bench.path(folder).join("result.json")).expect("a result");
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} is no number: {value}"))
}

#[test]
fn without_a_case_the_example_is_solved_and_its_files_written() {
    let bench = Bench::new();
    let printed = bench.succeeds(&["press"]);
    for word in [
        "peak pressure",
        "mean pressure",
        "length",
        "width",
        "area",
        "approach",
        "estimated error",
        "solved in",
    ] {
        assert!(printed.contains(word), "{word:?} is missing: {printed}");
    }
    assert_eq!(bench.names(), ["out"]);
    let expected = [
        "contact.vtp",
        "field.vtu",
        "hull.glb",
        "pressure.exr",
        "pressure.png",
        "result.json",
    ];
    assert_eq!(names(&bench.path("out")), expected);
    let result = result(&bench, "out");
    for key in [
        "p_max_pa",
        "p_max_error_pa",
        "p_mean_pa",
        "area_m2",
        "length_m",
        "width_m",
        "approach_m",
        "pitch_rad",
        "roll_rad",
        "fz_n",
        "kkt_residual",
        "dofs",
        "iterations",
        "seconds",
        "peak_memory_bytes",
    ] {
        assert!(number(&result, key).is_finite());
    }
    // Stresses are extrapolated to the nodes: in field.vtu they exceed the pressure, which the summary states.
    let stress = number(&result, "stress_max_pa");
    let more = stress / number(&result, "p_max_mesh_pa") - 1.0;
    assert!((0.03..0.15).contains(&more), "{more}");
    let note = format!("{:.1} MPa (stress", 1e-6 * stress);
    assert!(printed.contains(&note), "{note:?} is missing: {printed}");
    assert_eq!(result["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(result["case"]["load"]["fz_n"], 1000.0);
    assert_eq!(result["case"]["track"]["radius_m"], "inf");
    // Rigid Hertz on a half-space gives 138.52 MPa; 50 mm of ice on a rigid bed differ by less than the
    // requested per cent (the patch is 0.3 mm wide).
    let p_max = number(&result, "p_max_pa");
    assert!((p_max / 138.52e6 - 1.0).abs() < 0.012, "{p_max}");
    assert!(number(&result, "p_max_error_pa") <= 0.01 * p_max);
    assert!((number(&result, "fz_n") / 1000.0 - 1.0).abs() < 1e-8);
    // The energy falls from step to step of a mesh, to the one that the mesh states.
    for mesh in result["history"].as_array().expect("a history") {
        let steps = mesh["energy_steps_j"].as_array().expect("energies");
        let steps: Vec<f64> = steps.iter().filter_map(Value::as_f64).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
        assert_eq!(steps.last(), mesh["energy_j"].as_f64().as_ref());
    }
}

#[test]
fn pressures_beyond_ice_bring_a_warning_that_names_the_remedy() {
    let bench = Bench::new();
    let output = bench.kufe(&["press", "--quiet"]);
    assert!(
        errors(&output).contains("hardness_pa"),
        "{}",
        errors(&output)
    );
    assert!(output.stdout.is_empty());
    let bounded = CASE.replace(
        "thickness_m = 0.05",
        "thickness_m = 0.05\nhardness_pa = 30e6",
    );
    bench.write("case.toml", bounded);
    let output = bench.kufe(&["press", "case.toml", "-o", "bounded"]);
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        errors(&output)
    );
    assert!(number(&result(&bench, "bounded"), "p_max_pa") <= 30e6 * (1.0 + 1e-9));
    let by_temperature = CASE.replace(
        "thickness_m = 0.05",
        "thickness_m = 0.05\nhardness_pa = \"from-temperature\"\ntemperature_c = -5",
    );
    bench.write("cold.toml", by_temperature);
    let printed = bench.succeeds(&["press", "cold.toml", "-o", "cold"]);
    assert!(
        printed.contains("17.70 MPa (all that the ice bears)"),
        "{printed}"
    );
}

/// Ice and steel in series give the reference table's 134.6221 MPa for this runner as a paraboloid.
#[test]
fn an_elastic_runner_agrees_with_hertz_and_has_its_own_field() {
    let bench = Bench::new();
    let elastic = CASE
        .replace("[ice]", "elastic = true\n[ice]")
        .replace("p_max = 0.02", "p_max = 0.005");
    let shape = CASE.lines().nth(1).expect("the shape's line");
    let paraboloid =
        "shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }";
    let unbounded = elastic
        .replace(shape, paraboloid)
        .replace("thickness_m = 0.05", "thickness_m = \"half-space\"");
    bench.write("unbounded.toml", unbounded);
    bench.succeeds(&["press", "unbounded.toml", "-o", "unbounded"]);
    let p_max = number(&result(&bench, "unbounded"), "p_max_pa");
    assert!((p_max / 134.6221e6 - 1.0).abs() < 0.007, "{p_max}");
    bench.write("bounded.toml", elastic);
    bench.succeeds(&["press", "bounded.toml", "-o", "bounded"]);
    let p_max = number(&result(&bench, "bounded"), "p_max_pa");
    assert!((p_max / 134.6221e6 - 1.0).abs() < 0.015, "{p_max}");
    for folder in ["unbounded", "bounded"] {
        let mut expected = vec![
            "contact.vtp",
            "field.vtu",
            "hull.glb",
            "pressure.exr",
            "pressure.png",
            "result.json",
            "runner.vtu",
            "stress.png",
        ];
        // A paraboloid has no ends, and so no hull to write.
        expected.retain(|name| folder == "bounded" || *name != "hull.glb");
        assert_eq!(names(&bench.path(folder)), expected);
        let file = std::fs::read(bench.path(folder).join("runner.vtu")).expect("runner.vtu");
        let mesh = kufe_mesh::read_vtu(&file).expect("hexahedra");
        assert!(mesh.cells.len() > 1000, "{} cells", mesh.cells.len());
    }
}

/// Under the runner's keel the stress in the steel is that in the ice: -p, within the averaging over one cell.
#[test]
fn the_runners_stress_at_the_contact_is_the_pressure() {
    let bench = Bench::new();
    bench.write("case.toml", CASE.replace("[ice]", "elastic = true\n[ice]"));
    bench.succeeds(&["press", "case.toml"]);
    let script = "import sys, meshio, numpy as np\n\
        m = meshio.read(sys.argv[1])\n\
        s, u = m.point_data['stress_pa'].reshape(-1, 9), m.point_data['displacement_m']\n\
        z = m.points[:, 2]\n\
        k = np.argmin(np.linalg.norm(m.points[:, :2], axis=1) + z)\n\
        top = z > z.max() - 1e-9\n\
        print(-s[k, 8], np.abs(u[top]).max(), u[k, 2], np.isfinite(s).all())\n";
    let runner = bench.path("out/runner.vtu");
    let Some(printed) = python(script, &[&runner.to_string_lossy()]) else {
        return;
    };
    let words: Vec<&str> = printed.split_whitespace().collect();
    let [normal, fixed, pressed] = [0, 1, 2].map(|k| words[k].parse::<f64>().expect("a number"));
    let p_max = number(&result(&bench, "out"), "p_max_pa");
    assert!(
        (normal / p_max - 1.0).abs() < 0.1,
        "{normal} against {p_max}"
    );
    assert_eq!((fixed, words[3]), (0.0, "True"));
    assert!(pressed > 0.0 && pressed < 2e-6, "{pressed}");
}

#[test]
fn json_on_standard_output_is_the_result_file() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let printed = bench.succeeds(&["press", "case.toml", "--json"]);
    let printed: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(printed, result(&bench, "out"));
}

/// Each part of a result is there once: a contact that slides and a runner that deforms have them all.
#[test]
fn a_result_reads_back_as_its_struct_and_names_what_its_peak_is_uncertain_by() {
    let bench = Bench::new();
    bench.write(
        "slides.toml",
        format!("{CASE}[sliding]\nv_mps = 25.0\nice_c = -5.0\n"),
    );
    bench.write("bends.toml", CASE.replace("[ice]", "elastic = true\n[ice]"));
    for (case, more) in [("slides.toml", None), ("bends.toml", Some("--subsurface"))] {
        let words = ["press", case, "-o", "out"];
        bench.succeeds(&words.into_iter().chain(more).collect::<Vec<_>>());
        let mut written = result(&bench, "out");
        let read: ContactResult = serde_json::from_value(written.clone()).expect("a result");
        written
            .as_object_mut()
            .map(|keys| keys.shift_remove("files"));
        assert_eq!(serde_json::to_value(&read).expect("JSON"), written);
        assert_eq!(read.sliding.is_some(), more.is_none());
        assert_eq!(read.runner.is_some(), more.is_some());
        assert!(read.peak_error_parts()[0].error <= read.p_max.error);
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "one", "--threads", "1"]);
    bench.succeeds(&["press", "case.toml", "-o", "two", "--threads", "2"]);
    for name in ["pressure.exr", "pressure.png", "field.vtu"] {
        let [one, two] =
            ["one", "two"].map(|folder| std::fs::read(bench.path(folder).join(name)).expect(name));
        assert!(one == two, "{name} differs");
    }
}

#[test]
fn a_case_that_init_writes_solves_to_the_examples_figures() {
    let bench = Bench::new();
    bench.succeeds(&["init", "case.toml"]);
    bench.succeeds(&["press", "case.toml", "-o", "a"]);
    bench.succeeds(&["press", "-o", "b"]);
    let [a, b] = ["a", "b"].map(|folder| number(&result(&bench, folder), "p_max_pa"));
    assert_eq!(a, b);
}

#[test]
fn info_shows_the_maps_size_and_place() {
    let bench = Bench::new();
    bench.succeeds(&["press"]);
    let facts: Value =
        serde_json::from_str(&bench.succeeds(&["info", "out/pressure.exr", "--json"]))
            .expect("JSON");
    assert_eq!(facts["channels"], serde_json::json!(["gap", "p", "uz"]));
    assert_eq!(
        facts["attributes"]["fz_n"],
        number(&result(&bench, "out"), "fz_n")
    );
    assert!(number(&facts, "width") >= 100.0 && number(&facts, "height") >= 100.0);
}

/// The interpreter that has OpenEXR, pyvista and the like, where there is one.
fn python(script: &str, arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new(kufe_outside::python("OpenEXR, pyvista")?)
        .args(["-c", script])
        .args(arguments)
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(output.status.success(), "{}", errors(&output));
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn openexr_reads_a_map_that_carries_the_force_peak_and_area() {
    let bench = Bench::new();
    bench.succeeds(&["press"]);
    let script = "import sys, OpenEXR, numpy as np\n\
        f = OpenEXR.File(sys.argv[1], separate_channels=True)\n\
        h, c = f.header(), f.channels()\n\
        assert sorted(c) == ['gap', 'p', 'uz'], sorted(c)\n\
        assert all(v.pixels.dtype == np.float32 for v in c.values())\n\
        assert h['type'] == OpenEXR.scanlineimage\n\
        p = c['p'].pixels.astype(float)\n\
        a = float(h['pixel_x_m'][0]) * float(h['pixel_y_m'][0])\n\
        touching = c['gap'].pixels[p > 0.7 * p.max()]\n\
        print(p.sum() * a, p.max(), (p > 0).sum() * a, p.min(), touching.max())\n";
    let exr = bench.path("out/pressure.exr");
    let Some(printed) = python(script, &[&exr.to_string_lossy()]) else {
        return;
    };
    let numbers: Vec<f64> = printed
        .split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect();
    let result = result(&bench, "out");
    let relative = |value: f64, key: &str| (value / number(&result, key) - 1.0).abs();
    assert!(relative(numbers[0], "fz_n") < 1e-5, "force {}", numbers[0]);
    assert!(
        relative(numbers[1], "p_max_pa") < 0.01,
        "peak {}",
        numbers[1]
    );
    // Hertz: the mean of the pressure is two thirds of its peak.
    let area = 1.5 * number(&result, "fz_n") / number(&result, "p_max_pa");
    assert!(
        (numbers[2] / area - 1.0).abs() < 0.01,
        "{} {area}",
        numbers[2]
    );
    assert!(
        (numbers[2] - number(&result, "area_m2")).abs() < number(&result, "area_error_m2"),
        "area {}",
        numbers[2]
    );
    // Within half a patch's last of four cells, which the rim may cut, no pixel has a gap: p there is over 0.66 of the peak.
    assert_eq!((numbers[3], numbers[4]), (0.0, 0.0));
}

#[test]
fn exrheader_reads_the_map() {
    let bench = Bench::new();
    bench.succeeds(&["press"]);
    let Some(mut exrheader) = kufe_outside::program("exrheader") else {
        return;
    };
    let output = exrheader
        .arg(bench.path("out/pressure.exr"))
        .output()
        .expect("exrheader");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success());
    for part in [
        "scanlineimage",
        "p, 32-bit floating-point",
        "pixel_x_m (type double)",
        "radius_m (type double): inf",
    ] {
        assert!(printed.contains(part), "{part:?} is missing: {printed}");
    }
}

/// SciPy and Octave read the content of result.json and pressure.exr, with units.
#[test]
fn scipy_and_octave_read_figures_errors_and_the_map_from_result_mat() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "--mat", "-o", ".", "--force"]);
    octave(
        bench.folder.path(),
        "m = load('result.mat'); r = jsondecode(fileread('result.json'));\
         assert(m.p_max_pa == r.p_max_pa && m.history(end).dofs == r.history(end).dofs);\
         assert(strcmp(m.units.area_error_m2, 'm^2') && strcmp(m.version, r.version));\
         assert(m.case.load.fz_n == 1000);\
         assert(all(size(m.pressure_pa) == [numel(m.y_m), numel(m.x_m)]));",
    );
    let script = "import json, numpy as np, sys\n\
        from scipy.io import loadmat\n\
        m = loadmat('result.mat', simplify_cells=True)\n\
        r = json.load(open('result.json'))\n\
        numbers = [k for k, v in r.items() if type(v) in (int, float)]\n\
        assert len(numbers) > 20 and all(m[k] == r[k] for k in numbers), numbers\n\
        assert m['units']['p_max_error_pa'] == 'Pa' and m['units']['approach_m'] == 'm'\n\
        assert m['units']['area_error_m2'] == 'm^2' and 'dofs' not in m['units']\n\
        assert m['case']['load']['fz_n'] == r['case']['load']['fz_n'] and m['version'] == r['version']\n\
        assert m['history'][-1]['dofs'] == r['history'][-1]['dofs']\n\
        p, x, y = m['pressure_pa'], m['x_m'], m['y_m']\n\
        assert p.shape == (len(y), len(x)) == m['map_gap_m'].shape\n\
        assert abs(p.max() / r['p_max_map_pa'] - 1) < 1e-6\n\
        force = p.sum() * (x[1] - x[0]) * (y[1] - y[0])\n\
        print(force / r['fz_n'], p.max() / r['p_max_mesh_pa'], np.ptp(x) / np.ptp(y))\n";
    let Some(interpreter) = kufe_outside::python("scipy") else {
        return;
    };
    let output = std::process::Command::new(interpreter)
        .args(["-c", script])
        .current_dir(bench.folder.path())
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(output.status.success(), "{}", errors(&output));
    let printed = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = printed
        .split_whitespace()
        .map(|n| n.parse().expect("a number"))
        .collect();
    // The map carries the load; its largest pixel is the mesh's peak or a little next to it; the patch is long along x.
    assert!((numbers[0] - 1.0).abs() < 1e-3, "{printed}");
    assert!(numbers[1] <= 1.001 && numbers[1] > 0.98, "{printed}");
    assert!(numbers[2] > 50.0, "{printed}");
}
