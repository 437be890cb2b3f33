//! The forms that other programs read, each read by its own program.

mod common;

use common::runner;
use kufe_lut::{Axes, Check, Error, Flush, Lookup, Mode, Point, Quantity, Table};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// A table over reduced curvatures.
fn reduced() -> Table {
    let flush = Flush::new(0.02, 1e-6, [-0.02, 0.03]).unwrap();
    let places = vec![0.0, 0.2, 0.5, 0.55, 0.8, 1.0];
    let axes = Axes::reduced(vec![200.0, 500.0, 1300.0, 3000.0, 8000.0], places, flush).unwrap();
    let nodes = axes.points().iter().map(runner).collect();
    let point = Point {
        fz: 777.0,
        curvature: 0.0201,
        rocker_radius: None,
    };
    let checks = vec![Check {
        point,
        solved: runner(&point),
    }];
    Table::new(axes, nodes, checks).unwrap()
}

fn table(rocker: bool) -> Table {
    let axes = Axes::new(
        vec![200.0, 500.0, 1300.0, 3000.0, 8000.0],
        vec![-0.02, 0.0, 0.01, 0.02, 0.028],
        rocker.then(|| vec![20.0, 25.0, 30.0]),
    )
    .unwrap();
    let nodes = axes.points().iter().map(runner).collect();
    let point = Point {
        fz: 777.0,
        curvature: 0.015,
        rocker_radius: rocker.then_some(22.0),
    };
    let checks = vec![Check {
        point,
        solved: runner(&point),
    }];
    let mut table = Table::new(axes, nodes, checks).unwrap();
    table.case = serde_json::json!({ "runner": "a \"round\" & <steep> one", "radius_m": "inf" });
    table.case_sha256 = "0123abc".into();
    table.interpolation_asked = Some(0.01);
    table
}

/// The interpreter with the scientific packages, where there is one with `module`.
fn python(module: &str) -> Option<String> {
    let Ok(python) = std::env::var("KUFE_PYTHON") else {
        println!("skipped: KUFE_PYTHON is not set");
        return None;
    };
    let found = Command::new(&python)
        .args(["-c", &format!("import {module}")])
        .status();
    if !found.is_ok_and(|status| status.success()) {
        println!("skipped: {python} has no {module}");
        return None;
    }
    Some(python)
}

fn run_python(python: &str, folder: &Path, script: &str) -> String {
    let output = Command::new(python)
        .arg("-c")
        .arg(script)
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8(output.stdout).unwrap()
}

fn written(table: &Table, folder: &Path) {
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    table.write(&mut file("front.lut")).unwrap();
    table.write_csv(&mut file("front.csv")).unwrap();
    table.write_mat(&mut file("front.mat")).unwrap();
}

#[test]
fn a_file_read_back_is_the_same_table_to_the_bit() {
    for table in [table(false), table(true), reduced()] {
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        let back = Table::read(&mut bytes.as_slice()).unwrap();
        assert_eq!(back, table);
        let mut again = Vec::new();
        back.write(&mut again).unwrap();
        assert_eq!(again, bytes);
    }
}

#[test]
fn broken_files_are_named_by_place() {
    let mut bytes = Vec::new();
    table(false).write(&mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    let told = |text: &str| Table::read(&mut text.as_bytes()).unwrap_err().to_string();
    for (from, to, expected) in [
        ("\"kufe-lut\"", "\"other\"", "format: found other"),
        (
            "\"format_version\": 1",
            "\"format_version\": 9",
            "format_version: found 9",
        ),
        ("\"fz_n\",\"unit\"", "\"f\",\"unit\"", "axes[0]: found f"),
        ("[200.0,500.0", "[500.0,500.0", "value 1 = 500"),
        (
            "[200.0,500.0",
            "[null,500.0",
            "axes[0].values[0]: found null",
        ),
        (
            "\"p_mean\": {\"unit",
            "\"p_meen\": {\"unit",
            "quantities: found the key p_meen",
        ),
        (
            "\"unit\":\"Pa\"",
            "\"unit\":\"MPa\"",
            "quantities.p_max: found MPa",
        ),
        (
            "\"area\": {\"unit\":\"m2\",\"values\":[[",
            "\"area\": {\"unit\":\"m2\",\"values\":[[1.0,",
            "quantities.area.values[0]",
        ),
        (
            "\"checks\": [",
            "\"checks\": [3,",
            "checks[0]: found a number",
        ),
        ("\"version\": ", "\"vorsion\": ", "vorsion"),
    ] {
        assert!(good.contains(from), "{from}");
        let text = told(&good.replacen(from, to, 1));
        assert!(text.contains(expected), "{text} lacks {expected}");
    }
    assert!(told(&good[..good.len() / 2]).contains("line"));
    assert!(told("").contains("line 1"));
    let deep = "[".repeat(100_000);
    assert!(told(&deep).contains("recursion"));
    let huge = good.replacen("[200.0", &format!("[{}200.0", "1.0,".repeat(5000)), 1);
    assert!(told(&huge).contains("axis fz_n has"));
}

#[test]
fn broken_reduced_axes_are_named_by_place() {
    let mut bytes = Vec::new();
    reduced().write(&mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    for (from, to, expected) in [
        ("\"format_version\": 2", "\"format_version\": 1", "axes[1]"),
        (
            "\"scale_1pm_per_n\":1e-6",
            "\"scale_1pm_per_n\":-1.0",
            "flush.scale_1pm_per_n = -1",
        ),
        (
            "\"from_1pm\":-0.02",
            "\"from_1pm\":0.7",
            "flush.curvature_1pm = 0.02",
        ),
        (
            "\"to_1pm\"",
            "\"two_1pm\"",
            "axes[1].flush: found the key two_1pm",
        ),
        (
            "0.8,1.0]",
            "0.8,1.5]",
            "axis reduced_curvature, value 5 = 1.5",
        ),
    ] {
        assert!(good.contains(from), "{from}\n{}", &good[..900]);
        let text = Table::read(&mut good.replacen(from, to, 1).as_bytes())
            .unwrap_err()
            .to_string();
        assert!(text.contains(expected), "{text} lacks {expected}");
    }
}

#[test]
fn numpy_reads_reduced_curvatures_and_computes_the_bilinear_mode_from_them() {
    let Some(python) = python("scipy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = reduced();
    written(&table, folder.path());
    let out = run_python(
        &python,
        folder.path(),
        "import json, numpy as np\n\
         from scipy.io import loadmat\n\
         from scipy.interpolate import RegularGridInterpolator\n\
         t = json.load(open('front.lut'))\n\
         fz, second = t['axes']\n\
         flush = [second['flush'][k] for k in ('curvature_1pm', 'scale_1pm_per_n', 'from_1pm', 'to_1pm')]\n\
         def reduced(f, k):\n\
         \x20 s = lambda c: np.arcsinh((c - flush[0]) / (flush[1] * f))\n\
         \x20 return (s(k) - s(flush[2])) / (s(flush[3]) - s(flush[2]))\n\
         p = RegularGridInterpolator((fz['values'], second['values']), np.array(t['quantities']['p_max']['values']))\n\
         m = loadmat('front.mat')\n\
         assert np.array_equal(m['flush'][0], flush) and np.array_equal(m['reduced_curvature'][0], second['values'])\n\
         assert np.array_equal(m['curvature_1pm'], second['curvature_1pm'])\n\
         assert np.array_equal(m['p_max_pa'], t['quantities']['p_max']['values'])\n\
         csv = np.genfromtxt('front.csv', delimiter=',', names=True)\n\
         assert np.array_equal(csv['curvature_1pm'], np.ravel(second['curvature_1pm']))\n\
         for f, k in ((250.0, 0.0), (1234.5, 0.0212), (7000.0, 0.0299)):\n\
         \x20 print(f, k, repr(float(p([f, reduced(f, k)])[0])))\n",
    );
    let lookup = Lookup::new(&table, Quantity::PMax, Mode::Bilinear).unwrap();
    assert_eq!(out.lines().count(), 3);
    for line in out.lines() {
        let numbers: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        let own = lookup.at(numbers[0], numbers[1]).value;
        assert!((own / numbers[2] - 1.0).abs() < 1e-13, "{own} {line}");
    }
}

#[test]
fn pandas_reads_json_and_csv() {
    let Some(python) = python("pandas") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = table(false);
    written(&table, folder.path());
    let out = run_python(
        &python,
        folder.path(),
        "import json, pandas as pd\n\
         t = json.load(open('front.lut'))\n\
         fz, k = (axis['values'] for axis in t['axes'])\n\
         p = pd.DataFrame(t['quantities']['p_max']['values'], index=fz, columns=k)\n\
         c = pd.read_csv('front.csv', float_precision='round_trip').pivot(index='fz_n', columns='curvature_1pm', values='p_max_pa')\n\
         assert (c == p).all().all() and list(c.index) == fz\n\
         checks = pd.DataFrame(t['checks'])\n\
         assert t['quantities']['p_max']['unit'] == 'Pa' and t['accuracy']['interpolation_asked'] == 0.01\n\
         print(repr(p.loc[1300.0, 0.01]), repr(checks.p_max_pa[0]), t['accuracy']['interpolation']['smooth']['p_max']['max'])\n",
    );
    let numbers: Vec<f64> = out
        .split_whitespace()
        .map(|w| {
            w.trim_start_matches("np.float64(")
                .trim_end_matches(')')
                .parse()
                .unwrap()
        })
        .collect();
    assert_eq!(numbers[0], table.nodes()[table.axes().node(2, 2, 0)].p_max);
    assert_eq!(numbers[1], table.checks()[0].solved.p_max);
    let measured = table
        .interpolation_error(Quantity::PMax, Mode::Smooth)
        .unwrap()
        .unwrap();
    assert_eq!(numbers[2], measured.max);
}

#[test]
fn scipy_reads_the_mat_file_and_its_linear_interpolation_agrees() {
    let Some(python) = python("scipy") else {
        return;
    };
    for rocker in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let table = table(rocker);
        written(&table, folder.path());
        let out = run_python(
            &python,
            folder.path(),
            "from scipy.io import loadmat\n\
             from scipy.interpolate import RegularGridInterpolator\n\
             m = loadmat('front.mat')\n\
             axes = [m[a][0] for a in ('fz_n', 'curvature_1pm', 'rocker_radius_m') if a in m]\n\
             f = RegularGridInterpolator(axes, m['p_max_pa'])\n\
             print(repr(float(f([1234.5, 0.0123, 23.4][:len(axes)])[0])), m['area_m2'].shape[-1], str(m['version'][0]), str(m['case_json'][0]))\n",
        );
        let words: Vec<&str> = out.split_whitespace().collect();
        let scipy: f64 = words[0].parse().unwrap();
        let radius = rocker.then_some(23.4);
        let lookup = Lookup::with_rocker(&table, Quantity::PMax, Mode::Bilinear, radius).unwrap();
        let own = lookup.at(1234.5, 0.0123).value;
        assert!((own / scipy - 1.0).abs() < 1e-14, "{own} {scipy}");
        assert_eq!(words[1], if rocker { "3" } else { "5" });
        assert_eq!(words[2], table.version);
        assert!(out.contains(r#""a \"round\" & <steep> one""#));
    }
}

#[test]
fn the_header_compiles_and_computes_what_the_library_computes() {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("skipped: there is no cc");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (front, rear, flush) = (table(false), table(true), reduced());
    let write = |table: &Table, name: &str, radius| {
        let mut file = std::fs::File::create(folder.path().join(format!("{name}.h"))).unwrap();
        table.write_header(name, radius, &mut file).unwrap();
    };
    write(&front, "front", None);
    write(&rear, "2-rear", Some(25.0));
    write(&flush, "flush", None);
    let mut points = Vec::new();
    for i in 0..40 {
        for j in 0..40 {
            points.push((100.0 * 1.13f64.powi(i), -0.025 + 0.0015 * f64::from(j)));
        }
    }
    points.extend([
        (200.0, 0.0),
        (8000.0, 0.028),
        (1e300, -1.0),
        (f64::NAN, 0.0),
        (500.0, f64::NAN),
    ]);
    let mut main = String::from(
        "#include <stdio.h>\n#include \"front.h\"\n#include \"2-rear.h\"\n#include \"flush.h\"\n\
         static void show(kufe_lut_looked l) { printf(\"%.17g %d\\n\", l.value, l.out_of_range); }\n\
         int main(void) {\n  static const double at[][2] = {\n",
    );
    for (fz, curvature) in &points {
        let c = |v: &f64| {
            if v.is_nan() {
                "NAN".into()
            } else {
                format!("{v:e}")
            }
        };
        writeln!(main, "    {{ {}, {} }},", c(fz), c(curvature)).unwrap();
    }
    main += "  };\n  for (unsigned n = 0; n < sizeof at / sizeof at[0]; ++n) {\n";
    for own in ["front", "lut_2_rear", "flush"] {
        for quantity in Quantity::ALL {
            for mode in Mode::ALL {
                writeln!(
                    main,
                    "    show({own}_{}_{}(at[n][0], at[n][1]));",
                    quantity.name(),
                    mode.name()
                )
                .unwrap();
            }
        }
    }
    main +=
        "  }\n  printf(\"%.17g\\n\", kufe_lut_curvature_from_pitch(31.0, -0.7));\n  return 0;\n}\n";
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let compiled = Command::new("cc")
        .args([
            "-std=c99",
            "-pedantic",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-O2",
            "main.c",
            "-o",
            "main",
            "-lm",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let output = Command::new(folder.path().join("main")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text.lines();
    let lookups: Vec<Lookup> = [(&front, None), (&rear, Some(25.0)), (&flush, None)]
        .into_iter()
        .flat_map(|(table, radius)| {
            Quantity::ALL.into_iter().flat_map(move |quantity| {
                Mode::ALL.map(|mode| Lookup::with_rocker(table, quantity, mode, radius).unwrap())
            })
        })
        .collect();
    for &(fz, curvature) in &points {
        for lookup in &lookups {
            let (value, flag) = lines.next().unwrap().split_once(' ').unwrap();
            let value: f64 = value.parse().unwrap();
            let own = lookup.at(fz, curvature);
            assert_eq!(flag == "1", own.out_of_range);
            if own.value.is_nan() {
                assert!(value.is_nan());
            } else {
                // The same operations in the same order; only log and exp may come from another libm.
                assert!(
                    (value / own.value - 1.0).abs() < 1e-14,
                    "{value} {}",
                    own.value
                );
                if lookup.mode() == Mode::Bilinear && !lookup.is_reduced() {
                    assert_eq!(value, own.value);
                }
            }
        }
    }
    let curvature: f64 = lines.next().unwrap().parse().unwrap();
    assert_eq!(curvature, kufe_lut::curvature_from_pitch(31.0, -0.7));
}

#[test]
fn an_export_of_a_rocker_table_asks_for_one_of_its_radii() {
    let table = table(true);
    let told = |radius| {
        table
            .write_header("front", radius, &mut Vec::new())
            .unwrap_err()
    };
    assert!(matches!(told(None), Error::RockerNeeded { .. }));
    assert!(told(Some(24.0)).to_string().contains("20, 25, 30"));
    assert!(
        table
            .write_fmu("front", Some(25.0), &mut Vec::new())
            .is_ok()
    );
}

#[test]
fn the_fmu_is_valid_and_simulates_what_the_library_computes() {
    let Some(python) = python("fmpy") else { return };
    for table in [table(false), reduced()] {
        the_fmu_agrees(&python, &table);
    }
}

fn the_fmu_agrees(python: &str, table: &Table) {
    let folder = tempfile::tempdir().unwrap();
    let mut file = std::fs::File::create(folder.path().join("front.fmu")).unwrap();
    table.write_fmu("front <&>", None, &mut file).unwrap();
    drop(file);
    let out = run_python(
        python,
        folder.path(),
        "import numpy as np, fmpy\n\
         from fmpy.validation import validate_fmu\n\
         problems = validate_fmu('front.fmu')\n\
         assert not problems, problems\n\
         d = fmpy.read_model_description('front.fmu')\n\
         assert d.modelExchange and d.coSimulation and d.modelName == 'front <&>'\n\
         t = np.linspace(0, 1, 41)\n\
         s = np.zeros(41, dtype=[(n, float) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature')])\n\
         s['time'], s['fz'], s['v'], s['pitch_rate'] = t, 300 + 9000 * t, 30.0, -0.6 * t\n\
         s['curvature'] = 0.03 - 0.06 * t\n\
         for kind in ('CoSimulation', 'ModelExchange'):\n\
         \x20 for smooth in (True, False):\n\
         \x20   for use in (False, True):\n\
         \x20     r = fmpy.simulate_fmu('front.fmu', fmi_type=kind, step_size=0.025, output_interval=0.025, stop_time=1.0, input=s, solver='Euler',\n\
         \x20       start_values=dict(smooth=smooth, use_curvature=use), output=['fz', 'v', 'pitch_rate', 'curvature', 'pressure', 'out_of_range'])\n\
         \x20     assert len(r) >= 41, len(r)\n\
         \x20     for row in r:\n\
         \x20       print(kind, int(smooth), int(use), *(repr(float(row[n])) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature', 'pressure')), int(row['out_of_range']))\n",
    );
    let (mut inside, mut outside) = (0, 0);
    for line in out.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |n: usize| words[n].parse::<f64>().unwrap();
        let mode = if words[1] == "1" {
            Mode::Smooth
        } else {
            Mode::Bilinear
        };
        let curvature = if words[2] == "1" {
            number(7)
        } else {
            kufe_lut::curvature_from_pitch(number(5), number(6))
        };
        let own = Lookup::new(table, Quantity::PMax, mode)
            .unwrap()
            .at(number(4), curvature);
        let pressure = number(8);
        assert!(
            (pressure / own.value - 1.0).abs() < 1e-14,
            "{line} {}",
            own.value
        );
        // In Model Exchange the flag moves at the event after the step that left the table.
        if words[0] == "CoSimulation" {
            assert_eq!(words[9] == "1", own.out_of_range, "{line}");
        }
        if words[9] == "1" {
            outside += 1;
        } else {
            inside += 1;
        }
    }
    assert!(inside > 100 && outside > 40, "{inside} {outside}");
}
