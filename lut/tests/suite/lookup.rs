//! Interpolation over force and curvature: nodes, order, smoothness, and Simulink's arithmetic.

use crate::hertz::{hertz, runner};
use kufe_lut::{Axes, AxisKind, Figures, Interpolator, Mode, Point, Quantity, Table};
use proptest::prelude::*;

fn table(axes: Axes) -> Table {
    let nodes: Vec<Figures> = axes.points().iter().map(runner).collect();
    Table::new(axes, &nodes, vec![]).unwrap()
}

fn plain(table: &Table, mode: Mode) -> Interpolator {
    Interpolator::new(table, Quantity::PMax, mode, None).unwrap()
}

fn runner_axes() -> Axes {
    let fz = vec![200.0, 500.0, 900.0, 2000.0, 3700.0, 8000.0];
    let curvature = vec![-0.02, -0.01, 0.0, 0.004, 0.01, 0.02, 0.025, 0.028];
    Axes::new(fz, curvature).unwrap()
}

/// A table whose peak pressure is given row by row.
fn of_values(fz: Vec<f64>, curvature: Vec<f64>, values: &[f64]) -> Table {
    let axes = Axes::new(fz, curvature).unwrap();
    let nodes = values.iter().map(|&p_max| {
        let figures = Figures::at_rest([p_max, p_max, 1.0, 1.0, 1.0, 1.0]);
        figures.with_error(Quantity::PMax, 0.0)
    });
    Table::new(axes, &nodes.collect::<Vec<_>>(), vec![]).unwrap()
}

#[test]
fn the_tests_hertz_agrees_with_independent_values() {
    // rocker, section, load, a, b, p_max, approach; computed elsewhere in double precision with
    // SciPy's elliptic integrals.
    let rows = [
        [
            30.0,
            0.005,
            1000.0,
            2.513351e-2,
            1.371417e-4,
            1.385220e8,
            1.240901e-5,
        ],
        [
            20.0,
            0.004,
            250.0,
            1.374851e-2,
            8.292398e-5,
            1.046998e8,
            5.585084e-6,
        ],
        [
            0.01,
            0.01,
            100.0,
            4.203216e-4,
            4.203216e-4,
            2.702576e8,
            1.766703e-5,
        ],
    ];
    for [rocker, section, fz, a, b, p_max, approach] in rows {
        let solved = hertz(fz, rocker * (1.0 + 1e-9), section);
        for (found, expected) in [
            (solved.get(Quantity::Length).unwrap() / 2.0, a),
            (solved.get(Quantity::Width).unwrap() / 2.0, b),
            (solved.get(Quantity::PMax).unwrap(), p_max),
            (solved.get(Quantity::Approach).unwrap(), approach),
        ] {
            assert!((found / expected - 1.0).abs() < 2e-4, "{found} {expected}");
        }
    }
}

#[test]
fn both_modes_reproduce_nodes_exactly() {
    let table = table(runner_axes());
    for &quantity in Quantity::of(false) {
        for mode in Mode::ALL {
            let lookup = Interpolator::new(&table, quantity, mode, None).unwrap();
            for (point, node) in table.axes().points().iter().zip(table.nodes()) {
                let found = lookup.at(Point::at_rest(point.fz, point.curvature));
                assert_eq!(Some(found.value), node.get(quantity), "{mode:?} {point}");
                assert!(!found.out_of_range);
            }
        }
    }
}

#[test]
fn outside_is_clipped_and_flagged_and_nan_stays_nan() {
    let table = table(runner_axes());
    for mode in Mode::ALL {
        let lookup = plain(&table, mode);
        let inside = lookup.at(Point::at_rest(8000.0, 0.003)).value;
        for fz in [8000.1, 1e9, f64::INFINITY] {
            let found = lookup.at(Point::at_rest(fz, 0.003));
            assert!(found.out_of_range);
            assert_eq!(found.value, inside);
        }
        let found = lookup.at(Point::at_rest(f64::NEG_INFINITY, f64::NEG_INFINITY));
        assert_eq!(found.value, lookup.at(Point::at_rest(200.0, -0.02)).value);
        assert!(found.out_of_range);
        for (fz, curvature) in [(f64::NAN, 0.0), (1000.0, f64::NAN)] {
            let found = lookup.at(Point::at_rest(fz, curvature));
            assert!(found.value.is_nan() && found.out_of_range);
        }
    }
}

#[test]
fn one_breakpoint_is_enough() {
    let table = table(Axes::new(vec![1000.0], vec![0.0]).unwrap());
    for mode in Mode::ALL {
        let lookup = plain(&table, mode);
        assert_eq!(
            lookup.at(Point::at_rest(500.0, 0.1)).value,
            table.values(Quantity::PMax).unwrap()[0]
        );
        assert!(lookup.at(Point::at_rest(500.0, 0.0)).out_of_range);
        assert!(!lookup.at(Point::at_rest(1000.0, 0.0)).out_of_range);
    }
}

#[test]
fn smooth_mode_is_exact_for_power_laws_in_the_load() {
    let axes = Axes::new(vec![200.0, 1300.0, 8000.0], vec![0.0, 0.01]).unwrap();
    let table = table(axes);
    for &quantity in Quantity::of(false) {
        let lookup = Interpolator::new(&table, quantity, Mode::Smooth, None).unwrap();
        for fz in [250.0, 777.0, 3000.0, 7999.0] {
            let truth = hertz(fz, 30.0, 0.005).get(quantity).unwrap();
            assert!((lookup.at(Point::at_rest(fz, 0.0)).value / truth - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn smooth_mode_meets_cell_borders_with_one_slope() {
    let table = table(runner_axes());
    let lookup = plain(&table, Mode::Smooth);
    let axes = table.axes();
    // One-sided second-order differences: of the order of step^2 f''' ~ 1e-8 relative apart on a C1
    // surface.
    let slope = |f: &dyn Fn(f64) -> f64, at: f64, step: f64| {
        (-3.0 * f(at) + 4.0 * f(at + step) - f(at + 2.0 * step)) / (2.0 * step)
    };
    let mut kinks_of_bilinear = 0;
    let rough = plain(&table, Mode::Bilinear);
    for &curvature in &axes.curvature()[1..axes.curvature().len() - 1] {
        for fz in [230.0, 500.0, 1234.0, 5000.0] {
            let along = |k: f64| lookup.at(Point::at_rest(fz, k)).value;
            let (before, after) = (
                slope(&along, curvature, -1e-6),
                slope(&along, curvature, 1e-6),
            );
            let scale = lookup.at(Point::at_rest(fz, curvature)).value * 30.0;
            assert!((before - after).abs() < 1e-4 * scale, "{before} {after}");
            let along = |k: f64| rough.at(Point::at_rest(fz, k)).value;
            let gap = slope(&along, curvature, -1e-6) - slope(&along, curvature, 1e-6);
            kinks_of_bilinear += usize::from(gap.abs() > 1e-2 * scale);
        }
    }
    assert!(
        kinks_of_bilinear > 10,
        "the comparison must be able to fail"
    );
    for &fz in &axes.fz()[1..axes.fz().len() - 1] {
        for curvature in [-0.013, 0.0, 0.0123, 0.027] {
            let along = |f: f64| lookup.at(Point::at_rest(f, curvature)).value;
            let step = 1e-4 * fz;
            let (before, after) = (slope(&along, fz, -step), slope(&along, fz, step));
            assert!((before / after - 1.0).abs() < 1e-5, "{before} {after}");
        }
    }
}

#[test]
fn a_million_queries_equal_a_plain_reference() {
    let table = table(runner_axes());
    let (fz, curvature) = (table.axes().fz(), table.axes().curvature());
    let values = table.values(Quantity::PMax).unwrap();
    let value = |i: usize, j: usize| values[table.axes().node(i, j, 0)];
    let bilinear = plain(&table, Mode::Bilinear);
    let smooth = plain(&table, Mode::Smooth);
    let mut state = 7u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..1_000_000 {
        let (f, k) = (100.0 + 9000.0 * random(), -0.025 + 0.06 * random());
        // Weights of the four corners, found by a walk along the axes.
        let cell = |axis: &[f64], v: f64| {
            let v = v.clamp(axis[0], axis[axis.len() - 1]);
            let mut n = 0;
            while n + 2 < axis.len() && axis[n + 1] <= v {
                n += 1;
            }
            (n, (v - axis[n]) / (axis[n + 1] - axis[n]))
        };
        let ((i, s), (j, t)) = (cell(fz, f), cell(curvature, k));
        let corners = [
            value(i, j),
            value(i + 1, j),
            value(i, j + 1),
            value(i + 1, j + 1),
        ];
        let reference = (1.0 - s) * (1.0 - t) * corners[0]
            + s * (1.0 - t) * corners[1]
            + (1.0 - s) * t * corners[2]
            + s * t * corners[3];
        let found = bilinear.at(Point::at_rest(f, k));
        assert!((found.value / reference - 1.0).abs() < 1e-14);
        let outside = !(200.0..=8000.0).contains(&f) || !(-0.02..=0.028).contains(&k);
        assert_eq!(found.out_of_range, outside);
        // Monotone along both axes, so no corner is overshot.
        let found = smooth.at(Point::at_rest(f, k));
        let lowest = corners.into_iter().fold(f64::INFINITY, f64::min);
        let highest = corners.into_iter().fold(0.0, f64::max);
        assert!(found.value >= lowest * (1.0 - 1e-13) && found.value <= highest * (1.0 + 1e-13));
        assert_eq!(found.out_of_range, outside);
    }
}

#[test]
fn a_rocker_axis_gives_the_table_of_each_radius() {
    let radii = vec![20.0, 30.0, 45.0];
    let (fz, curvature) = (vec![200.0, 1000.0, 8000.0], vec![0.0, 0.005, 0.015]);
    let whole = table(
        Axes::new(fz.clone(), curvature.clone())
            .unwrap()
            .with(AxisKind::RockerRadius, radii.clone())
            .unwrap(),
    );
    for &radius in &radii {
        let axes = Axes::new(fz.clone(), curvature.clone()).unwrap();
        let nodes = axes.points().into_iter();
        let nodes = nodes.map(|p| hertz(p.fz, 1.0 / (1.0 / radius - p.curvature), 0.005));
        let single = Table::new(axes, &nodes.collect::<Vec<_>>(), vec![]).unwrap();
        for mode in Mode::ALL {
            let a = Interpolator::new(&whole, Quantity::PMax, mode, Some(radius)).unwrap();
            let b = plain(&single, mode);
            assert_eq!(
                a.at(Point::at_rest(700.0, 0.003)),
                b.at(Point::at_rest(700.0, 0.003))
            );
        }
    }
    let between = Interpolator::new(&whole, Quantity::PMax, Mode::Smooth, Some(36.0)).unwrap();
    let truth = hertz(1000.0, 36.0, 0.005).get(Quantity::PMax).unwrap();
    assert!((between.at(Point::at_rest(1000.0, 0.0)).value / truth - 1.0).abs() < 2e-3);
    assert!(Interpolator::new(&whole, Quantity::PMax, Mode::Smooth, None).is_err());
    assert!(Interpolator::new(&whole, Quantity::PMax, Mode::Smooth, Some(50.0)).is_err());
    assert!(Interpolator::new(&whole, Quantity::PMax, Mode::Smooth, Some(f64::NAN)).is_err());
}

/// Breakpoints with uneven steps, and values that rise along both axes (some steps level).
fn rising() -> impl Strategy<Value = (Vec<f64>, Vec<f64>, Vec<f64>)> {
    (1usize..6, 1usize..6)
        .prop_flat_map(|(nx, ny)| {
            let step = || prop_oneof![0.01f64..0.1, 0.5f64..2.0];
            let rise = || prop_oneof![Just(0.0), 0.001f64..0.01, 0.5f64..3.0];
            (
                proptest::collection::vec(step(), nx + 1),
                proptest::collection::vec(step(), ny + 1),
                proptest::collection::vec(rise(), (nx + 1) * (ny + 1)),
            )
        })
        .prop_map(|(xs, ys, rises)| {
            let sum = |steps: &[f64]| {
                steps
                    .iter()
                    .scan(0.1, |at, step| {
                        *at += step;
                        Some(*at)
                    })
                    .collect::<Vec<_>>()
            };
            let (x, y) = (sum(&xs), sum(&ys));
            let columns = y.len();
            let mut values = vec![0.0f64; x.len() * columns];
            for i in 0..x.len() {
                for j in 0..columns {
                    let left = if i > 0 {
                        values[(i - 1) * columns + j]
                    } else {
                        1.0
                    };
                    let below = if j > 0 {
                        values[i * columns + j - 1]
                    } else {
                        1.0
                    };
                    values[i * columns + j] = left.max(below) + rises[i * columns + j];
                }
            }
            (x, y, values)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn monotone_data_stay_monotone(
        (x, y, values) in rising(),
        flip_x: bool,
        flip_y: bool,
        at in proptest::collection::vec((0.0f64..1.0, 0.0f64..1.0, 0.0f64..1.0), 40),
    ) {
        let columns = y.len();
        let flipped: Vec<f64> = (0..values.len()).map(|n| {
            let (i, j) = (n / columns, n % columns);
            let i = if flip_x { x.len() - 1 - i } else { i };
            let j = if flip_y { columns - 1 - j } else { j };
            values[i * columns + j]
        }).collect();
        let table = of_values(x.clone(), y.clone(), &flipped);
        for mode in Mode::ALL {
            let lookup = plain(&table, mode);
            let scale = |axis: &[f64], t: f64| axis[0] + t * (axis[axis.len() - 1] - axis[0]);
            for &(s, t, u) in &at {
                let (low, high) = (s.min(t), s.max(t));
                let across = scale(&y, u);
                let rise = lookup.at(Point::at_rest(scale(&x, high), across)).value - lookup.at(Point::at_rest(scale(&x, low), across)).value;
                prop_assert!(rise * if flip_x { -1.0 } else { 1.0 } >= -1e-12, "along x {mode:?}: {rise}");
                let across = scale(&x, u);
                let rise = lookup.at(Point::at_rest(across, scale(&y, high))).value - lookup.at(Point::at_rest(across, scale(&y, low))).value;
                prop_assert!(rise * if flip_y { -1.0 } else { 1.0 } >= -1e-12, "along y {mode:?}: {rise}");
            }
        }
    }

    #[test]
    fn any_data_are_finite_and_c1_with_no_overshoot_along_grid_lines(
        values in proptest::collection::vec(0.1f64..10.0, 30),
        t in 0.0f64..1.0,
    ) {
        let x = vec![1.0, 1.1, 2.0, 2.5, 4.0, 9.0];
        let y = vec![-1.0, 0.0, 0.1, 2.0, 2.2];
        let table = of_values(x.clone(), y.clone(), &values);
        let lookup = plain(&table, Mode::Smooth);
        for i in 0..5 {
            for j in 0..5 {
                let between = x[i] + t * (x[i + 1] - x[i]);
                let (a, b) = (values[i * 5 + j], values[(i + 1) * 5 + j]);
                let value = lookup.at(Point::at_rest(between, y[j])).value;
                prop_assert!(value >= a.min(b) * (1.0 - 1e-12) && value <= a.max(b) * (1.0 + 1e-12));
            }
        }
        for &border in &x[1..5] {
            let across = -1.0 + 3.2 * t;
            let f = |s: f64| lookup.at(Point::at_rest(border + s, across)).value;
            let h = 1e-6;
            let before = (3.0 * f(0.0) - 4.0 * f(-h) + f(-2.0 * h)) / (2.0 * h);
            let after = (-3.0 * f(0.0) + 4.0 * f(h) - f(2.0 * h)) / (2.0 * h);
            prop_assert!((before - after).abs() < 1e-4 * (1.0 + before.abs()), "{before} {after}");
        }
    }
}
