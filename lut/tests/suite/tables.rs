//! Two tables that every form is written from.

use crate::hertz::runner;
use kufe_lut::{Axes, Check, Flush, Point, Table};

/// A table over reduced curvatures.
pub fn reduced() -> Table {
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

/// A table over plain curvatures, with or without a rocker axis.
pub fn table(rocker: bool) -> Table {
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
