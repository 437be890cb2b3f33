//! Interpolation over speed and temperature of the ice.

use crate::hertz::runner;
use crate::tables::{slid, sliding, table};
use kufe_lut::{
    Axes, AxisKind, Error, Figures, Interpolator, Mode, Outside, Point, Quantity, Table,
};

#[test]
fn both_modes_reproduce_nodes_exactly() {
    let table = sliding(false);
    for &quantity in table.quantities() {
        for mode in Mode::ALL {
            let lookup = Interpolator::new(&table, quantity, mode, None).unwrap();
            for (point, node) in table.axes().points().iter().zip(table.nodes()) {
                let found = lookup.at(*point);
                assert!(!found.out_of_range);
                assert_eq!(Some(found.value), node.get(quantity), "{mode:?} {point}");
            }
        }
    }
}

#[test]
fn outside_is_clipped_and_flagged_and_nan_stays_nan() {
    let table = sliding(false);
    for mode in Mode::ALL {
        let mu = Interpolator::new(&table, Quantity::Mu, mode, None).unwrap();
        let edge = mu.at(Point::sliding(700.0, 0.0, 40.0, -12.0));
        assert!(!edge.out_of_range);
        for (v, ice) in [(41.0, -12.0), (40.0, -13.0), (f64::INFINITY, -1e300)] {
            let found = mu.at(Point::sliding(700.0, 0.0, v, ice));
            assert!(found.out_of_range && found.value == edge.value, "{v} {ice}");
        }
        for (v, ice) in [(f64::NAN, -5.0), (20.0, f64::NAN)] {
            let found = mu.at(Point::sliding(700.0, 0.0, v, ice));
            assert!(found.out_of_range && found.value.is_nan());
        }
    }
}

#[test]
fn an_infinite_speed_past_a_linear_axis_of_two_breakpoints_is_flagged() {
    let axes = Axes::new(vec![500.0, 1000.0], vec![0.0, 0.01]).unwrap();
    let axes = axes.with(AxisKind::Speed, vec![5.0, 40.0]).unwrap();
    let nodes: Vec<Figures> = axes.points().iter().map(slid).collect();
    let table = Table::new(axes, &nodes, vec![]).unwrap();
    let table = table.with_outside(AxisKind::Speed, Outside::Linear);
    for mode in Mode::ALL {
        let mu = Interpolator::new(&table, Quantity::Mu, mode, None).unwrap();
        let found = mu.at(Point::sliding(1000.0, 0.01, f64::INFINITY, -5.0));
        assert!(found.out_of_range, "{found:?}");
    }
}

#[test]
fn an_axis_that_is_not_there_is_ignored() {
    let table = table(false);
    for mode in Mode::ALL {
        let p_max = Interpolator::new(&table, Quantity::PMax, mode, None).unwrap();
        for fz in [100.0, 200.0, 777.0, 5000.0] {
            for curvature in [-0.03, 0.0, 0.0123, 0.028] {
                let found = p_max.at(Point::at_rest(fz, curvature));
                assert_eq!(found, p_max.at(Point::sliding(fz, curvature, 20.0, -5.0)));
            }
        }
    }
    let refused = Interpolator::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap_err();
    assert!(
        matches!(refused, Error::NoQuantity { quantity: "mu" }),
        "{refused}"
    );
}

#[test]
fn a_power_of_the_speed_times_an_exponential_of_the_temperature_is_found_up_exactly() {
    // Straight lines and a parabola in what the smooth mode interpolates.
    let law = |v: f64, t: f64| 1e-3 * v.powf(0.43) * (0.04 * t + 0.003 * t * t).exp();
    let axes = Axes::new(vec![500.0, 1000.0], vec![0.0, 0.01]).unwrap();
    let axes = axes
        .with(AxisKind::Speed, vec![1.0, 4.0, 30.0])
        .and_then(|axes| axes.with(AxisKind::IceTemperature, vec![-15.0, -6.0, -2.0, -1.0]))
        .unwrap();
    let nodes = axes.points().into_iter().map(|point| {
        slid(&point).with(
            Quantity::Mu,
            law(point.speed.unwrap(), point.ice_c.unwrap()),
        )
    });
    let nodes: Vec<Figures> = nodes.collect();
    let table = Table::new(axes.clone(), &nodes, vec![]).unwrap();
    let mu = Interpolator::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap();
    for v in [1.0, 1.7, 9.0, 29.0] {
        for t in [-15.0, -11.3, -4.0, -1.2] {
            let found = mu.at(Point::sliding(612.0, 0.003, v, t)).value;
            assert!((found / law(v, t) - 1.0).abs() < 1e-12, "{v} {t}");
        }
    }
}

#[test]
fn smooth_mode_meets_every_breakpoint_with_one_slope() {
    let table = sliding(false);
    let mu = Interpolator::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap();
    let along = |axis: usize, value: f64| {
        let mut x = [900.0, 0.004, 11.0, -4.4];
        x[axis] = value;
        mu.at(Point::sliding(x[0], x[1], x[2], x[3])).value
    };
    for (axis, _, values) in table
        .axes()
        .named()
        .into_iter()
        .enumerate()
        .map(|(n, (name, _, v))| (n, name, v))
    {
        for &at in &values[1..values.len() - 1] {
            let h = 1e-5 * (values[values.len() - 1] - values[0]);
            let f = |n: f64| along(axis, at + n * h);
            // One-sided slopes of second order; their difference is of the order of h.
            let before = (3.0 * f(0.0) - 4.0 * f(-1.0) + f(-2.0)) / (2.0 * h);
            let after = -(3.0 * f(0.0) - 4.0 * f(1.0) + f(2.0)) / (2.0 * h);
            let scale = before
                .abs()
                .max(along(axis, at) / (values[values.len() - 1] - values[0]));
            assert!(
                (before - after).abs() < 1e-4 * scale,
                "{axis} {at}: {before} {after}"
            );
        }
    }
}

#[test]
fn points_that_slide_and_points_at_rest_make_no_table() {
    let axes = sliding(false).axes().clone();
    let mut nodes: Vec<_> = axes.points().iter().map(slid).collect();
    nodes[7] = runner(&axes.points()[7]);
    let refused = Table::new(axes.clone(), &nodes, vec![]).unwrap_err();
    let text = refused.to_string();
    assert!(
        text.contains("v_mps = 6") && text.contains("sliding"),
        "{text}"
    );
    let rest: Vec<Figures> = axes.points().iter().map(runner).collect();
    assert!(Table::new(axes, &rest, vec![]).is_err());
}
