//! SciPy, a C compiler and an FMU simulator on the same table.

use crate::c::run_c;
use crate::python::run_python;
use crate::tables::sliding;
use kufe_lut::{Fmi, Interpolator, Mode, Point, Quantity, Table};
use kufe_outside::python;
use std::fmt::Write as _;
use std::path::Path;

fn written(table: &Table, folder: &Path) {
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    table.write(&mut file("front.lut")).unwrap();
    table.write_csv(&mut file("front.csv")).unwrap();
    table.write_mat(&mut file("front.mat")).unwrap();
}

#[test]
fn scipy_interpolates_four_and_five_axes_as_the_bilinear_mode_does() {
    let Some(python) = python("scipy") else {
        return;
    };
    for rocker in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let table = sliding(rocker);
        written(&table, folder.path());
        let out = run_python(
            &python,
            folder.path(),
            "import json, numpy as np\n\
             from scipy.io import loadmat\n\
             from scipy.interpolate import RegularGridInterpolator\n\
             t, m = json.load(open('front.lut')), loadmat('front.mat')\n\
             assert t['format_version'] == 1\n\
             csv = np.genfromtxt('front.csv', delimiter=',', names=True)\n\
             axes = [np.array(a['values']) for a in t['axes']]\n\
             names = [a['name'] for a in t['axes']]\n\
             grid = np.meshgrid(*axes, indexing='ij')\n\
             for name, axis, along in zip(names, axes, grid):\n\
             \x20 assert np.array_equal(m[name][0], axis) and np.array_equal(csv[name], along.ravel())\n\
             random = np.random.default_rng(1)\n\
             at = np.array([random.uniform(a[0], a[-1], 200) for a in axes]).T\n\
             if 'rocker_radius_m' in names: at[:, 2] = 23.4\n\
             values = np.array(t['quantities']['mu']['values'])\n\
             assert np.array_equal(m['mu'], values) and np.array_equal(csv['mu'], values.ravel())\n\
             f = RegularGridInterpolator(axes, values)\n\
             for x in at: print(*(repr(float(v)) for v in (*x, f(x)[0])))\n",
        );
        let radius = rocker.then_some(23.4);
        let mu = Interpolator::new(&table, Quantity::Mu, Mode::Bilinear, radius).unwrap();
        assert_eq!(out.lines().count(), 200);
        for line in out.lines() {
            let x: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
            let [v, ice, scipy] = x[x.len() - 3..] else {
                panic!()
            };
            let own = mu.at(Point::sliding(x[0], x[1], v, ice)).value;
            assert!((own / scipy - 1.0).abs() < 1e-13, "{own} {line}");
        }
    }
}

#[test]
fn scipys_hermite_splines_through_the_layers_are_the_smooth_mode() {
    let Some(python) = python("scipy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = sliding(false);
    written(&table, folder.path());
    // At a node of force and curvature the layers are the nodes. NumPy's gradient of second order
    // is the three-point slope.
    let out = run_python(
        &python,
        folder.path(),
        "import json, numpy as np\n\
         from scipy.interpolate import CubicHermiteSpline\n\
         t = json.load(open('front.lut'))\n\
         v, ice = (np.array(a['values']) for a in t['axes'][2:])\n\
         w = np.log(np.array(t['quantities']['mu']['values'])[2, 1])\n\
         spline = lambda x, y: CubicHermiteSpline(x, y, np.gradient(y, x, axis=0, edge_order=2))\n\
         random = np.random.default_rng(2)\n\
         for a, b in zip(random.uniform(v[0], v[-1], 200), random.uniform(ice[0], ice[-1], 200)):\n\
         \x20 print(repr(float(a)), repr(float(b)), repr(float(np.exp(spline(ice, spline(np.log(v), w)(np.log(a)))(b)))))\n",
    );
    let mu = Interpolator::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap();
    assert_eq!(out.lines().count(), 200);
    for line in out.lines() {
        let x: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        let own = mu.at(Point::sliding(1300.0, 0.0, x[0], x[1])).value;
        assert!((own / x[2] - 1.0).abs() < 1e-12, "{own} {line}");
    }
}

#[test]
fn the_header_computes_what_the_library_computes() {
    let folder = tempfile::tempdir().unwrap();
    let (front, rear) = (sliding(false), sliding(true));
    let write = |table: &Table, name: &str, radius| {
        let mut file = std::fs::File::create(folder.path().join(format!("{name}.h"))).unwrap();
        table.write_header(name, radius, &mut file).unwrap();
    };
    write(&front, "front", None);
    write(&rear, "rear", Some(25.0));
    let mut points = Vec::new();
    for i in 0..7 {
        for j in 0..6 {
            for k in 0..9 {
                let (i, j, k) = (f64::from(i), f64::from(j), f64::from(k));
                points.push([
                    150.0 * 2f64.powf(i),
                    -0.025 + 0.009 * j,
                    1.0 + 5.0 * k,
                    -13.0 + 1.5 * k,
                ]);
                points.push([
                    300.0 * 1.5f64.powf(i),
                    0.005 * j,
                    45.0 - 5.0 * k,
                    -12.0 + 2.3 * j,
                ]);
            }
        }
    }
    let mut main = String::from(
        "#include <stdio.h>\n#include \"front.h\"\n#include \"rear.h\"\n\
         static void show(kufe_lut_interpolated l) { printf(\"%.17g %d\\n\", l.value, l.out_of_range); }\n\
         int main(void) {\n  static const double at[][4] = {\n",
    );
    for [fz, curvature, v, ice] in &points {
        writeln!(main, "    {{ {fz:e}, {curvature:e}, {v:e}, {ice:e} }},").unwrap();
    }
    main += "  };\n  for (unsigned n = 0; n < sizeof at / sizeof at[0]; ++n) {\n";
    let mut lookups = Vec::new();
    for (own, table, radius) in [("front", &front, None), ("rear", &rear, Some(25.0))] {
        for &quantity in table.quantities() {
            for mode in Mode::ALL {
                let call = format!("{own}_{}_{}", quantity.name(), mode.name());
                writeln!(
                    main,
                    "    show({call}(at[n][0], at[n][1], at[n][2], at[n][3]));"
                )
                .unwrap();
                lookups.push(Interpolator::new(table, quantity, mode, radius).unwrap());
            }
        }
    }
    main += "  }\n  show(front_mu_smooth(900.0, 0.0, NAN, -5.0));\n  return 0;\n}\n";
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let Some(text) = run_c(folder.path(), "main.c", &[], "") else {
        return;
    };
    let mut lines = text.lines();
    let (mut inside, mut outside) = (0, 0);
    for &[fz, curvature, v, ice] in &points {
        for lookup in &lookups {
            let (value, flag) = lines.next().unwrap().split_once(' ').unwrap();
            let value: f64 = value.parse().unwrap();
            let own = lookup.at(Point::sliding(fz, curvature, v, ice));
            assert_eq!(flag == "1", own.out_of_range);
            // The same operations in the same order; only log and exp may come from another libm.
            assert!(
                (value / own.value - 1.0).abs() < 1e-13,
                "{value} {}",
                own.value
            );
            if own.out_of_range {
                outside += 1;
            } else {
                inside += 1;
            }
        }
    }
    assert!(inside > 1000 && outside > 1000, "{inside} {outside}");
    assert_eq!(lines.next(), Some("nan 1"));
}

#[test]
fn the_fmu_is_valid_and_has_the_friction_of_speed_and_temperature() {
    let Some(python) = python("fmpy") else { return };
    for fmi in [Fmi::V2, Fmi::V3] {
        the_fmu_agrees(&python, fmi);
    }
}

fn the_fmu_agrees(python: &Path, fmi: Fmi) {
    let folder = tempfile::tempdir().unwrap();
    let table = sliding(false);
    let mut file = std::fs::File::create(folder.path().join("front.fmu")).unwrap();
    table.write_fmu("front", None, fmi, &mut file).unwrap();
    drop(file);
    let out = run_python(
        python,
        folder.path(),
        "import numpy as np, fmpy\n\
         from fmpy.validation import validate_fmu\n\
         problems = validate_fmu('front.fmu')\n\
         assert not problems, problems\n\
         t = np.linspace(0, 1, 41)\n\
         s = np.zeros(41, dtype=[(n, float) for n in ('time', 'fz', 'v', 'pitch_rate', 'curvature', 'ice_c')])\n\
         s['time'], s['fz'], s['v'], s['curvature'], s['ice_c'] = t, 300 + 9000 * t, 1 + 45 * t, 0.03 - 0.06 * t, -14 + 15 * t\n\
         names = ('fz', 'v', 'curvature', 'ice_c', 'pressure', 'mu', 'mu_ploughing', 'mu_viscous', 'mu_boundary', 'groove_depth', 'film_mean')\n\
         for kind in ('CoSimulation', 'ModelExchange'):\n\
         \x20 for smooth in (True, False):\n\
         \x20   r = fmpy.simulate_fmu('front.fmu', fmi_type=kind, step_size=0.025, output_interval=0.025, stop_time=1.0, input=s, solver='Euler',\n\
         \x20     start_values=dict(smooth=smooth, use_curvature=True), output=[*names, 'out_of_range'])\n\
         \x20   assert len(r) >= 41, len(r)\n\
         \x20   for row in r:\n\
         \x20     print(int(smooth), int(row['out_of_range']), *(repr(float(row[n])) for n in names))\n",
    );
    let (mut inside, mut outside) = (0, 0);
    for line in out.lines() {
        let x: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        let mode = if x[0] == 1.0 {
            Mode::Smooth
        } else {
            Mode::Bilinear
        };
        let quantities = [
            Quantity::PMax,
            Quantity::Mu,
            Quantity::MuPloughing,
            Quantity::MuViscous,
            Quantity::MuBoundary,
            Quantity::GrooveDepth,
            Quantity::FilmMean,
        ];
        for (quantity, value) in quantities.into_iter().zip(&x[6..]) {
            let lookup = Interpolator::new(&table, quantity, mode, None).unwrap();
            let own = lookup.at(Point::sliding(x[2], x[3 + 1], x[3], x[5]));
            assert!(
                (value / own.value - 1.0).abs() < 1e-13,
                "{quantity:?} {line}"
            );
            if own.out_of_range {
                outside += 1;
            } else {
                inside += 1;
            }
        }
    }
    assert!(inside > 100 && outside > 100, "{inside} {outside}");
}
