//! What evaluation over speed and temperature promises.

use crate::tables::{slid, sliding, table};
use kufe_lut::{Axes, Error, Layered, Lookup, Mode, Point, Quantity, Table};

#[test]
fn both_modes_reproduce_nodes_exactly() {
    let table = sliding(false);
    for &quantity in table.quantities() {
        for mode in Mode::ALL {
            let lookup = Layered::new(&table, quantity, mode, None).unwrap();
            for (point, node) in table.axes().points().iter().zip(table.nodes()) {
                let (v, ice) = (point.speed.unwrap(), point.ice_c.unwrap());
                let looked = lookup.at(point.fz, point.curvature, v, ice);
                assert!(!looked.out_of_range);
                assert_eq!(Some(looked.value), node.get(quantity), "{mode:?} {point}");
            }
        }
    }
}

#[test]
fn outside_is_clipped_and_flagged_and_nan_stays_nan() {
    let table = sliding(false);
    for mode in Mode::ALL {
        let mu = Layered::new(&table, Quantity::Mu, mode, None).unwrap();
        let edge = mu.at(700.0, 0.0, 40.0, -12.0);
        assert!(!edge.out_of_range);
        for (v, ice) in [(41.0, -12.0), (40.0, -13.0), (f64::INFINITY, -1e300)] {
            let looked = mu.at(700.0, 0.0, v, ice);
            assert!(
                looked.out_of_range && looked.value == edge.value,
                "{v} {ice}"
            );
        }
        for (v, ice) in [(f64::NAN, -5.0), (20.0, f64::NAN)] {
            let looked = mu.at(700.0, 0.0, v, ice);
            assert!(looked.out_of_range && looked.value.is_nan());
        }
    }
}

#[test]
fn an_axis_that_is_not_there_is_ignored_and_a_table_at_rest_is_its_plain_lookup() {
    let table = table(false);
    for mode in Mode::ALL {
        let plain = Lookup::new(&table, Quantity::PMax, mode).unwrap();
        let layered = Layered::new(&table, Quantity::PMax, mode, None).unwrap();
        for fz in [100.0, 200.0, 777.0, 5000.0] {
            for curvature in [-0.03, 0.0, 0.0123, 0.028] {
                let looked = layered.at(fz, curvature, f64::NAN, f64::NAN);
                assert_eq!(looked, plain.at(fz, curvature));
            }
        }
    }
    let told = Layered::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap_err();
    assert!(
        matches!(told, Error::NoQuantity { quantity: "mu" }),
        "{told}"
    );
    let told = Lookup::new(&sliding(false), Quantity::Mu, Mode::Smooth).unwrap_err();
    assert!(matches!(told, Error::LayersNeeded), "{told}");
}

#[test]
fn a_power_of_the_speed_times_an_exponential_of_the_temperature_is_looked_up_exactly() {
    // Straight lines and a parabola in what the smooth mode interpolates.
    let law = |v: f64, t: f64| 1e-3 * v.powf(0.43) * (0.04 * t + 0.003 * t * t).exp();
    let axes = Axes::new(vec![500.0, 1000.0], vec![0.0, 0.01], None).unwrap();
    let axes = axes
        .sliding(
            Some(vec![1.0, 4.0, 30.0]),
            Some(vec![-15.0, -6.0, -2.0, -1.0]),
        )
        .unwrap();
    let nodes = axes.points().into_iter().map(|point| {
        let mut solved = slid(&point);
        let sliding = solved.sliding.as_mut().unwrap();
        sliding.mu = law(point.speed.unwrap(), point.ice_c.unwrap());
        solved
    });
    let table = Table::new(axes.clone(), nodes.collect(), vec![]).unwrap();
    let mu = Layered::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap();
    for v in [1.0, 1.7, 9.0, 29.0] {
        for t in [-15.0, -11.3, -4.0, -1.2] {
            let looked = mu.at(612.0, 0.003, v, t).value;
            assert!((looked / law(v, t) - 1.0).abs() < 1e-12, "{v} {t}");
        }
    }
}

#[test]
fn smooth_mode_meets_every_breakpoint_with_one_slope() {
    let table = sliding(false);
    let mu = Layered::new(&table, Quantity::Mu, Mode::Smooth, None).unwrap();
    let along = |axis: usize, at: f64| {
        let mut x = [900.0, 0.004, 11.0, -4.4];
        x[axis] = at;
        mu.at(x[0], x[1], x[2], x[3]).value
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
            // One-sided slopes of second order; what is left is of the order of h.
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
    nodes[7].sliding = None;
    let told = Table::new(axes.clone(), nodes, vec![])
        .unwrap_err()
        .to_string();
    assert!(
        told.contains("v_mps = 6") && told.contains("sliding"),
        "{told}"
    );
    let rest = axes.points().into_iter().map(|p: Point| {
        let mut solved = slid(&p);
        solved.sliding = None;
        solved
    });
    assert!(Table::new(axes.clone(), rest.collect(), vec![]).is_err());
}
