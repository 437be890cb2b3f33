//! `kufe press` with lists: folders, table, PVD, resuming.

use kufe_outside::python;
use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, json, names};

fn table(bench: &Bench, folder: &str) -> Vec<Value> {
    let text = std::fs::read(bench.path(folder).join("table.json")).expect("a table");
    let table: Value = serde_json::from_slice(&text).expect("JSON");
    table.as_array().expect("rows").clone()
}

fn column(rows: &[Value], key: &str) -> Vec<f64> {
    rows.iter()
        .map(|row| row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}")))
        .collect()
}

fn rises(values: &[f64]) -> bool {
    values.windows(2).all(|w| w[0] < w[1])
}

/// p_max of a Hertz contact grows with the cube root of the load.
#[test]
fn a_list_of_loads_gives_a_folder_each_one_table_and_one_series() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let loads = ["press", "case.toml", "-o", "out", "--fz-n", "125,1000"];
    let printed = bench.succeeds(&loads);
    assert!(
        printed.contains("step-002") && printed.contains("2 steps"),
        "{printed}"
    );
    let expected = [
        "series.pvd",
        "step-001",
        "step-002",
        "table.csv",
        "table.json",
    ];
    assert_eq!(names(&bench.path("out")), expected);
    assert_eq!(
        names(&bench.path("out/step-002")),
        [
            "contact.vtp",
            "field.vtu",
            "hull.glb",
            "pressure.exr",
            "pressure.png",
            "result.json"
        ]
    );
    let rows = table(&bench, "out");
    let p_max = column(&rows, "p_max_pa");
    assert!((p_max[1] / p_max[0] - 2.0).abs() < 0.02, "{p_max:?}");
    let [error, second, its_error] =
        ["p_max_error_pa", "check_p_max_pa", "check_p_max_error_pa"].map(|key| column(&rows, key));
    for k in 0..2 {
        let apart = (p_max[k] - second[k]).abs();
        assert!(apart <= error[k] + its_error[k], "step {k}: {apart}");
    }
    let csv = std::fs::read_to_string(bench.path("out/table.csv")).expect("a table");
    let mut lines = csv.lines();
    assert!(
        lines
            .next()
            .is_some_and(|head| head.starts_with("step,folder,fz_n,p_max_pa,"))
    );
    assert_eq!(lines.count(), 2);
    // What is true of both steps is printed once.
    let reported = errors(&bench.kufe(&[&loads[..], &["--fresh"]].concat()));
    assert_eq!(
        reported.matches("above 10 MPa, and ice").count(),
        1,
        "{reported}"
    );
    assert!(reported.contains("one more step warns alike"), "{reported}");
    // Again: nothing is solved, nothing changes.
    let before = std::fs::read(bench.path("out/step-001/result.json")).expect("a result");
    let again = bench.succeeds(&loads);
    assert!(again.contains("2 of them there already"), "{again}");
    assert_eq!(
        before,
        std::fs::read(bench.path("out/step-001/result.json")).expect("a result")
    );
    // A longer list solves what is missing.
    let longer = bench.succeeds(&["press", "case.toml", "-o", "out", "--fz-n", "125,1000,2000"]);
    assert!(
        longer.contains("3 steps, 2 of them there already"),
        "{longer}"
    );
    assert!(rises(&column(&table(&bench, "out"), "p_max_pa")));
    // Another case is another result: its steps are solved again.
    bench.write("case.toml", CASE.replace("9.0e9", "4.5e9"));
    assert!(!bench.succeeds(&loads).contains("already"));
}

/// The paper's table: a smaller rocker radius gives a higher peak; tilting a runner off its keel shortens the contact.
#[test]
fn lists_multiply_and_a_smaller_rocker_radius_presses_harder() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&[
        "press",
        "case.toml",
        "--rocker-radius-m",
        "40,25,15",
        "--roll-rad",
        "0,0.02",
        "--radius-m",
        "inf",
    ]);
    let rows = table(&bench, "out");
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[0]["radius_m"], "inf");
    assert_eq!(
        column(&rows, "rocker_radius_m"),
        [40.0, 40.0, 25.0, 25.0, 15.0, 15.0]
    );
    assert_eq!(column(&rows, "roll_rad"), [0.0, 0.02, 0.0, 0.02, 0.0, 0.02]);
    let p_max = column(&rows, "p_max_pa");
    assert!(rises(&[p_max[0], p_max[2], p_max[4]]), "{p_max:?}");
    // A round section has no keel: rolling it moves the contact and changes nothing else.
    assert!((p_max[1] / p_max[0] - 1.0).abs() < 0.02, "{p_max:?}");
}

/// A hull is read and fitted once for all steps, and its scans are made up once: each step is the contact alone.
#[test]
fn steps_over_a_hull_equal_separate_contacts() {
    let bench = Bench::new();
    let made = ["hull", "bob", "-o", "bob.obj", "--length-m", "0.3"];
    bench.succeeds(&[&made[..], &["--edge-length-m", "0.001"]].concat());
    let shape = CASE.lines().nth(1).expect("a shape");
    let hull = CASE.replace(shape, "hull = \"bob.obj\"\nnoise_m = 5e-8");
    bench.write("case.toml", &hull);
    bench.succeeds(&["press", "case.toml", "-o", "out", "--fz-n", "500,1000"]);
    let figures = |folder: &str| {
        let result = json(&bench.path(folder).join("result.json"));
        [
            "p_max_pa",
            "p_max_error_pa",
            "p_max_noise_pa",
            "p_max_hull_pa",
        ]
        .map(|key| {
            let figure = result[key].as_f64();
            figure.unwrap_or_else(|| panic!("{key}: {result}"))
        })
    };
    for (step, load) in [("out/step-001", "500.0"), ("out/step-002", "1000.0")] {
        bench.write("one.toml", hull.replace("1000.0", load));
        bench.succeeds(&["press", "one.toml", "-o", "one"]);
        assert_eq!(figures(step), figures("one"), "{load} N");
    }
    assert_ne!(figures("out/step-001")[2], figures("out/step-002")[2]);
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn a_step_short_of_its_accuracy_is_reported_and_the_others_are_solved() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let output = bench.kufe(&["press", "case.toml", "--fz-n", "500,-1"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(
        errors(&output).contains("load.fz_n = -1"),
        "{}",
        errors(&output)
    );
    assert!(
        !bench.path("out").exists(),
        "nothing is solved before all cases are checked"
    );
    let output = bench.kufe(&["press", "case.toml", "--fz-n", "500,many"]);
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
    // A flat with sharp edges: its peak has no value, so no mesh is fine enough.
    let sharp = "[runner.section]\nworn_m = 0.5e-6\nworn_edge = 0.0\n[ice]";
    let case = CASE
        .replace("[ice]", sharp)
        .replace("p_max = 0.02", "p_max = 0.0005");
    bench.write("flat.toml", case);
    let output = bench.kufe(&["press", "flat.toml", "--fz-n", "1000,1100"]);
    assert_eq!(output.status.code(), Some(4), "{}", errors(&output));
    let rows = table(&bench, "out");
    assert!(
        rows[0]["p_max_pa"].is_number() && rows[0]["error"].is_string(),
        "{}",
        rows[0]
    );
}

/// A single value replaces that of the case: the result is that of a case with this value.
#[test]
fn single_values_are_no_series() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("heavy.toml", CASE.replace("fz_n = 1000.0", "fz_n = 125.0"));
    bench.succeeds(&["press", "heavy.toml", "-o", "expected"]);
    bench.succeeds(&["press", "case.toml", "-o", "out", "--fz-n", "125"]);
    let pressures = ["expected", "out"]
        .map(|folder| json(&bench.path(folder).join("result.json"))["p_max_pa"].as_f64());
    assert!(
        pressures[0].is_some() && pressures[0] == pressures[1],
        "{pressures:?}"
    );
    assert!(!bench.path("out/step-001").exists());
    let output = bench.kufe(&["press", "case.toml", "--fz-n=-1", "-o", "out", "--force"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(
        errors(&output).contains("load.fz_n = -1"),
        "{}",
        errors(&output)
    );
}

/// Under a line contact 0.300 of the peak at 0.786 of the half-width (Johnson, section 4.1).
#[test]
fn every_step_has_its_largest_shear_and_the_error_of_it() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let loads = ["press", "case.toml", "-o", "out", "--fz-n", "500,1000"];
    bench.succeeds(&[&loads[..], &["--subsurface"]].concat());
    for (row, step) in table(&bench, "out").iter().zip(["step-001", "step-002"]) {
        let result = json(&bench.path("out").join(step).join("result.json"));
        let of = |key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"));
        for key in [
            "max_shear_pa",
            "max_shear_error_pa",
            "max_shear_depth_m",
            "max_shear_depth_error_m",
        ] {
            assert_eq!(result["subsurface"][key], row[key], "{key}");
        }
        let (shear, error) = (of("max_shear_pa"), of("max_shear_error_pa"));
        let off = (shear - 0.300 * of("p_max_pa")).abs();
        assert!(off < error + 0.3 * of("p_max_error_pa"), "{row}");
        assert!(error < 0.05 * shear, "{row}");
        let (depth, error) = (of("max_shear_depth_m"), of("max_shear_depth_error_m"));
        let off = (depth - 0.786 * 0.5 * of("width_m")).abs();
        assert!(off < error + 0.4 * of("width_error_m"), "{row}");
        assert!(error < 0.2 * depth, "{row}");
    }
}

#[test]
fn pyvista_reads_the_series_as_time() {
    let Some(interpreter) = python("pyvista") else {
        return;
    };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&[
        "press",
        "case.toml",
        "--fz-n",
        "250,500,1000",
        "--subsurface",
    ]);
    let script = "import sys, pyvista\n\
        reader = pyvista.get_reader(sys.argv[1])\n\
        print(*reader.time_values)\n\
        for time in reader.time_values:\n\
        \x20   reader.set_active_time_value(time)\n\
        \x20   mesh = reader.read()[0]\n\
        \x20   print(mesh.n_cells, mesh.point_data['max_shear_pa'].max())\n";
    let output = std::process::Command::new(interpreter)
        .args(["-c", script])
        .arg(bench.path("out/series.pvd"))
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(output.status.success(), "{}", errors(&output));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines[0], "250.0 500.0 1000.0");
    let shear: Vec<f64> = lines[1..]
        .iter()
        .map(|line| {
            line.split_whitespace()
                .nth(1)
                .expect("two words")
                .parse()
                .expect("a number")
        })
        .collect();
    assert!(shear.len() == 3 && rises(&shear), "{printed}");
    let rows = table(&bench, "out");
    // The largest shear under a line-like contact is 0.3 of the peak pressure, whatever the load.
    for row in &rows {
        let share = row["max_shear_pa"].as_f64().expect("a number")
            / row["p_max_pa"].as_f64().expect("a number");
        assert!((share - 0.3).abs() < 0.01, "{share}");
    }
    let step = bench.path("out/step-001");
    for name in ["subsurface.csv", "subsurface.png"] {
        assert!(step.join(name).exists(), "{name}");
    }
}
