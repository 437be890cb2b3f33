//! Tables as NumPy, SciPy and pandas read them.

use crate::python::run_python;
use crate::tables::{reduced, table};
use kufe_lut::{Interpolator, Mode, Point, Quantity, Table};
use kufe_outside::python;
use std::path::Path;

fn written(table: &Table, folder: &Path) {
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    table.write(&mut file("front.lut")).unwrap();
    table.write_csv(&mut file("front.csv")).unwrap();
    table.write_mat(&mut file("front.mat")).unwrap();
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
    let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Bilinear, None).unwrap();
    assert_eq!(out.lines().count(), 3);
    for line in out.lines() {
        let numbers: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        let own = lookup.at(Point::at_rest(numbers[0], numbers[1])).value;
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
         assert t['quantities']['p_max']['unit'] == 'Pa' and t['accuracy']['interpolation_requested'] == 0.01\n\
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
    let p_max = table.values(Quantity::PMax).unwrap();
    assert_eq!(numbers[0], p_max[table.axes().node(2, 2, 0)]);
    let check = table.checks()[0].figures;
    assert_eq!(Some(numbers[1]), check.get(Quantity::PMax));
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
             u = loadmat('front.mat', simplify_cells=True)['units']\n\
             assert (u['fz_n'], u['curvature_1pm'], u['p_max_pa'], u['area_m2']) == ('N', '1/m', 'Pa', 'm^2'), u\n\
             assert set(u) == {k for k in m if k.rsplit('_', 1)[-1] in ('n', '1pm', 'm', 'pa', 'm2')}, u\n\
             print(repr(float(f([1234.5, 0.0123, 23.4][:len(axes)])[0])), m['area_m2'].shape[-1], str(m['version'][0]), str(m['case_json'][0]))\n",
        );
        let words: Vec<&str> = out.split_whitespace().collect();
        let scipy: f64 = words[0].parse().unwrap();
        let radius = rocker.then_some(23.4);
        let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Bilinear, radius).unwrap();
        let own = lookup.at(Point::at_rest(1234.5, 0.0123)).value;
        assert!((own / scipy - 1.0).abs() < 1e-14, "{own} {scipy}");
        assert_eq!(words[1], if rocker { "3" } else { "5" });
        assert_eq!(words[2], table.origin.version());
        assert!(out.contains(r#""a \"round\" & <steep> one""#));
    }
}
