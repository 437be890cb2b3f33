//! What becomes of inputs outside the axes, the same in Rust, C and Octave; and the derivatives in
//! C.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use kufe_lut::{AxisKind, Interpolator, Mode, OCTAVE_FUNCTION, Outside, Point, Quantity, Table};
use kufe_outside::{program, python};

use crate::c::run_c;
use crate::python::run_python;
use crate::tables::{reduced, sliding, table};

const KINDS: [AxisKind; 4] = [
    AxisKind::Fz,
    AxisKind::Curvature,
    AxisKind::Speed,
    AxisKind::IceTemperature,
];

fn with(table: Table, rules: [Outside; 4]) -> Table {
    let pairs = KINDS.into_iter().zip(rules);
    pairs.fold(table, |table, (kind, rule)| table.with_outside(kind, rule))
}

fn sample([fz, curvature, speed, ice_c]: [f64; 4]) -> Point {
    Point::sliding(fz, curvature, speed, ice_c)
}

/// Samples in the tables and outside of them, on every side.
fn samples(count: usize) -> Vec<[f64; 4]> {
    let mut state = 12_345u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let one = |_| {
        [
            100.0 * 150f64.powf(random()),
            -0.04 + 0.09 * random(),
            60f64.powf(random()),
            -16.0 + 17.0 * random(),
        ]
    };
    (0..count).map(one).collect()
}

/// The samples as lines.
fn lines(samples: &[[f64; 4]]) -> String {
    let mut text = String::new();
    for [fz, curvature, v, ice] in samples {
        writeln!(text, "{fz:e} {curvature:e} {v:e} {ice:e}").unwrap();
    }
    text
}

fn numbers(line: &str) -> Vec<f64> {
    let words = line.split_whitespace();
    words.map(|word| word.parse().unwrap()).collect()
}

/// Value, flag and derivatives of a quantity in a mode at every sample, by the C header.
fn in_c(table: &Table, quantity: Quantity, mode: Mode, at: &[[f64; 4]]) -> Option<Vec<Vec<f64>>> {
    let folder = tempfile::tempdir().unwrap();
    let mut file = std::fs::File::create(folder.path().join("front.h")).unwrap();
    table.write_header("front", None, &mut file).unwrap();
    let arguments = match table.axes().is_sliding() {
        true => "x[0], x[1], x[2], x[3]",
        false => "x[0], x[1]",
    };
    let function = format!("front_{}_{}", quantity.name(), mode.name());
    let main = format!(
        "#include <stdio.h>\n#include \"front.h\"\n\
         int main(void) {{\n  double x[4];\n  \
         while (scanf(\"%lf %lf %lf %lf\", x, x + 1, x + 2, x + 3) == 4) {{\n    \
         kufe_lut_interpolated plain = {function}({arguments});\n    \
         kufe_lut_derivatives d = {function}_derivatives({arguments});\n    \
         printf(\"%.17g %d %.17g %d %.17g %.17g %.17g %.17g\\n\", plain.value, plain.out_of_range, d.value,\n      \
         d.out_of_range, d.d_fz, d.d_curvature, d.d_v, d.d_ice_c);\n  }}\n  return 0;\n}}\n"
    );
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let printed = run_c(folder.path(), "main.c", &["-ffp-contract=off"], &lines(at))?;
    let rows: Vec<Vec<f64>> = printed.lines().map(numbers).collect();
    assert_eq!(rows.len(), at.len());
    Some(rows)
}

#[test]
fn values_and_derivatives_in_c_are_those_of_the_interpolant_inside_and_outside() {
    use Outside::{Hold, Linear};
    let at = samples(300);
    for (table, quantity) in [
        (table(false), Quantity::PMax),
        (table(false), Quantity::Approach),
        (reduced(), Quantity::PMax),
        (sliding(false), Quantity::Mu),
    ] {
        for rules in [[Hold; 4], [Linear; 4], [Linear, Hold, Hold, Linear]] {
            let table = with(table.clone(), rules);
            for mode in Mode::ALL {
                let Some(rows) = in_c(&table, quantity, mode, &at) else {
                    return;
                };
                let lookup = Interpolator::new(&table, quantity, mode, None).unwrap();
                let (mut outside, mut steepest) = (0, [0f64; 4]);
                for (x, row) in at.iter().zip(&rows) {
                    let own = lookup.at(sample(*x));
                    let context = format!("{} {mode:?} {rules:?} {x:?} {row:?}", quantity.name());
                    assert!(
                        (row[0] / own.value - 1.0).abs() < 1e-13,
                        "{context} {own:?}"
                    );
                    assert_eq!([row[0], row[1]], [row[2], row[3]], "{context}");
                    assert_eq!(row[1] == 1.0, own.out_of_range, "{context}");
                    outside += usize::from(own.out_of_range);
                    // Central differences of the library's values.
                    let spans = [x[0], 0.05, x[2], 10.0];
                    let steps = [1e-6 * x[0], 3e-8, 1e-6 * x[2], 1e-5];
                    for axis in 0..4 {
                        let moved = |step: f64| {
                            let mut moved = *x;
                            moved[axis] += step;
                            (moved[axis], lookup.at(sample(moved)).value)
                        };
                        let [(low, before), (high, after)] = [-steps[axis], steps[axis]].map(moved);
                        let difference = (after - before) / (high - low) * spans[axis];
                        let found = row[4 + axis] * spans[axis];
                        let allowed = 1e-6 * (own.value.abs() + found.abs());
                        assert!(
                            (found - difference).abs() < allowed,
                            "axis {axis}: {found} {difference}, {context}"
                        );
                        steepest[axis] = steepest[axis].max(found.abs() / own.value.abs());
                    }
                }
                assert!(outside > 50 && outside < 290, "{outside}");
                let axes = if table.axes().is_sliding() { 4 } else { 2 };
                assert!(
                    steepest[..axes].iter().all(|most| *most > 0.01),
                    "{steepest:?}"
                );
                assert!(
                    steepest[axes..].iter().all(|most| *most == 0.0),
                    "{steepest:?}"
                );
            }
        }
    }
}

#[test]
fn at_a_node_derivatives_are_those_of_the_cell_above_and_at_the_last_of_the_cell_below() {
    let table = table(false);
    let axis = table.axes().fz().to_vec();
    let at: Vec<[f64; 4]> = axis.iter().map(|&fz| [fz, 0.003, 0.0, 0.0]).collect();
    for mode in Mode::ALL {
        let Some(rows) = in_c(&table, Quantity::PMax, mode, &at) else {
            return;
        };
        let lookup = Interpolator::new(&table, Quantity::PMax, mode, None).unwrap();
        let value = |fz: f64| lookup.at(Point::at_rest(fz, 0.003)).value;
        for (k, (&fz, row)) in axis.iter().zip(&rows).enumerate() {
            let step = if k + 1 < axis.len() {
                1e-6 * fz
            } else {
                -1e-6 * fz
            };
            let difference = (value(fz + step) - value(fz)) / step;
            assert!(
                (row[4] / difference - 1.0).abs() < 1e-5,
                "{mode:?} {fz} {row:?} {difference}"
            );
        }
    }
}

#[test]
fn a_linear_axis_continues_a_power_law_in_the_smooth_mode() {
    // Hertz: the peak pressure grows with the cube root of the force.
    let table = with(table(false), [Outside::Linear; 4]);
    let p_max = Interpolator::new(&table, Quantity::PMax, Mode::Smooth, None).unwrap();
    let at = |fz: f64| p_max.at(Point::at_rest(fz, 0.01));
    for factor in [1.5, 3.0, 10.0] {
        let found = at(8000.0 * factor);
        assert!(found.out_of_range);
        assert!((found.value / at(8000.0).value / factor.cbrt() - 1.0).abs() < 1e-11);
    }
    // Below, the tangent in the force keeps it finite and positive down to a force of 0, where it
    // stays for a runner that has lifted off.
    for fz in [150.0, 1.0, 0.0, -500.0] {
        let found = at(fz);
        let exponent = (fz.max(0.0) / 200.0 - 1.0) / 3.0;
        assert!(found.out_of_range);
        assert!((found.value / at(200.0).value / exponent.exp() - 1.0).abs() < 1e-11);
    }
}

#[test]
fn an_axis_with_the_rule_error_has_no_value_outside() {
    let rules = [
        Outside::Hold,
        Outside::Hold,
        Outside::Error,
        Outside::Linear,
    ];
    let table = with(sliding(false), rules);
    let at = samples(200);
    for mode in Mode::ALL {
        let mu = Interpolator::new(&table, Quantity::Mu, mode, None).unwrap();
        let rows = in_c(&table, Quantity::Mu, mode, &at);
        for (n, x) in at.iter().enumerate() {
            let refused = !(2.0..=40.0).contains(&x[2]);
            let found = mu.at(sample(*x));
            assert_eq!(found.value.is_nan(), refused, "{x:?}");
            assert!(found.out_of_range || !refused);
            if let Some(rows) = &rows {
                assert_eq!(rows[n][0].is_nan(), refused, "{x:?}");
                assert_eq!(rows[n][1] == 2.0, refused, "{x:?}");
                assert_eq!(rows[n][4].is_nan(), refused, "{x:?}");
            }
        }
    }
}

#[test]
fn scipy_continues_a_table_as_the_bilinear_mode_does() {
    let Some(python) = python("scipy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let table = with(sliding(false), [Outside::Linear; 4]);
    let mut file = std::fs::File::create(folder.path().join("front.lut")).unwrap();
    table.write(&mut file).unwrap();
    let at = samples(200);
    std::fs::write(folder.path().join("at"), lines(&at)).unwrap();
    let printed = run_python(
        &python,
        folder.path(),
        "import json, numpy as np\n\
         from scipy.interpolate import RegularGridInterpolator\n\
         t = json.load(open('front.lut'))\n\
         assert [a['outside'] for a in t['axes']] == ['linear'] * 4\n\
         f = RegularGridInterpolator([a['values'] for a in t['axes']], np.array(t['quantities']['mu']['values']), bounds_error=False, fill_value=None)\n\
         for value in f(np.loadtxt('at')): print(repr(float(value)))\n",
    );
    let mu = Interpolator::new(&table, Quantity::Mu, Mode::Bilinear, None).unwrap();
    for (x, line) in at.iter().zip(printed.lines()) {
        let (own, scipy) = (mu.at(sample(*x)).value, numbers(line)[0]);
        // Far outside, a sum of large terms that cancel.
        assert!(
            (own - scipy).abs() < 1e-12 * own.abs().max(1e-2),
            "{x:?} {own} {scipy}"
        );
    }
    assert_eq!(printed.lines().count(), at.len());
}

#[test]
fn rules_survive_a_file_and_a_file_with_another_word_or_place_is_refused() {
    let rules = [
        Outside::Linear,
        Outside::Error,
        Outside::Hold,
        Outside::Linear,
    ];
    let table = with(sliding(true), rules);
    let mut bytes = Vec::new();
    table.write(&mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    assert_eq!(text.matches("\"outside\"").count(), 3);
    assert_eq!(Table::read(&mut text.as_bytes()).unwrap(), table);
    let wrong = text.replacen("\"linear\"", "\"nearest\"", 1);
    let refused = Table::read(&mut wrong.as_bytes()).unwrap_err().to_string();
    assert!(
        refused.contains("nearest") && refused.contains("hold"),
        "{refused}"
    );
    let unit = "\"name\":\"rocker_radius_m\",\"unit\":\"m\"";
    assert!(text.contains(unit));
    let wrong = text.replacen(unit, &format!("{unit},\"outside\":\"linear\""), 1);
    let refused = Table::read(&mut wrong.as_bytes()).unwrap_err().to_string();
    assert!(
        refused.contains("axes[2].outside: found linear"),
        "{refused}"
    );
}

/// Results of Octave's function on a MAT-file: value and flag at every sample.
fn in_octave(
    folder: &Path,
    table: &Table,
    key: &str,
    further: &str,
    at: &[[f64; 4]],
) -> Vec<Vec<f64>> {
    let mut file = std::fs::File::create(folder.join("front.mat")).unwrap();
    table.write_mat(&mut file).unwrap();
    std::fs::write(folder.join("kufe_lut_at.m"), OCTAVE_FUNCTION).unwrap();
    std::fs::write(folder.join("at"), lines(at)).unwrap();
    let script = format!(
        "t = load('front.mat'); at = load('at');\n\
         for n = 1:rows(at)\n  x = at(n, :);\n  \
         [value, outside] = kufe_lut_at(t, '{key}', x(1), x(2){further});\n  \
         printf('%.17g %d\\n', value, outside);\nend\n"
    );
    let ran = Command::new("octave-cli")
        .args(["--no-gui", "--norc", "--quiet", "--eval", &script])
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{error}");
    let printed = String::from_utf8(ran.stdout).unwrap();
    printed.lines().map(numbers).collect()
}

#[test]
fn octave_evaluates_a_mat_file_to_the_bit() {
    if program("octave-cli").is_none() {
        return;
    }
    let mixed = [
        Outside::Linear,
        Outside::Hold,
        Outside::Linear,
        Outside::Error,
    ];
    let slides = ", 'v_mps', x(3), 'ice_c', x(4)";
    let rocker = ", 'rocker_radius_m', 23.4, 'ice_c', x(4), 'v_mps', x(3)";
    let mut at = samples(60);
    at.extend([
        [200.0, 0.0, 2.0, -12.0],
        [8000.0, 0.02, 40.0, -1.0],
        [f64::NAN, 0.0, 9.0, -5.0],
    ]);
    for (table, quantity, further, radius, exact) in [
        (table(false), Quantity::PMax, "", None, true),
        (with(table(false), mixed), Quantity::Area, "", None, true),
        // Its logarithm may come from another libm.
        (with(reduced(), mixed), Quantity::PMax, "", None, false),
        (
            with(sliding(false), mixed),
            Quantity::Mu,
            slides,
            None,
            true,
        ),
        (
            with(sliding(true), mixed),
            Quantity::Mu,
            rocker,
            Some(23.4),
            true,
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let rows = in_octave(folder.path(), &table, quantity.key(), further, &at);
        let lookup = Interpolator::new(&table, quantity, Mode::Bilinear, radius).unwrap();
        assert_eq!(rows.len(), at.len());
        for (x, row) in at.iter().zip(&rows) {
            let own = lookup.at(sample(*x));
            assert_eq!(row[1] == 1.0, own.out_of_range, "{x:?}");
            if own.value.is_nan() {
                assert!(row[0].is_nan(), "{x:?}");
            } else if exact {
                assert_eq!(row[0], own.value, "{x:?}");
            } else {
                assert!((row[0] / own.value - 1.0).abs() < 1e-13, "{x:?} {own:?}");
            }
        }
    }
}
