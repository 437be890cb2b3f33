//! Two tables that every form is written from.

use crate::hertz::runner;
use kufe_lut::{Axes, AxisKind, CurvatureScaling, Figures, Origin, Point, Quantity, Solve, Table};

/// A table over reduced curvatures.
pub fn reduced() -> Table {
    let flush = CurvatureScaling::new(0.02, 1e-6, [-0.02, 0.03]).unwrap();
    let places = vec![0.0, 0.2, 0.5, 0.55, 0.8, 1.0];
    let axes = Axes::reduced(vec![200.0, 500.0, 1300.0, 3000.0, 8000.0], places, flush).unwrap();
    let nodes: Vec<Figures> = axes.points().iter().map(runner).collect();
    let point = Point {
        fz: 777.0,
        curvature: 0.0201,
        ..Point::default()
    };
    let checks = vec![Solve {
        point,
        figures: runner(&point),
    }];
    Table::new(axes, &nodes, checks).unwrap()
}

fn with_rocker(axes: Axes, rocker: bool) -> Axes {
    if !rocker {
        return axes;
    }
    axes.with(AxisKind::RockerRadius, vec![20.0, 25.0, 30.0])
        .unwrap()
}

/// A table over plain curvatures, with or without a rocker axis.
pub fn table(rocker: bool) -> Table {
    let axes = Axes::new(
        vec![200.0, 500.0, 1300.0, 3000.0, 8000.0],
        vec![-0.02, 0.0, 0.01, 0.02, 0.028],
    );
    let axes = with_rocker(axes.unwrap(), rocker);
    let nodes: Vec<Figures> = axes.points().iter().map(runner).collect();
    let point = Point {
        fz: 777.0,
        curvature: 0.015,
        rocker_radius: rocker.then_some(22.0),
        ..Point::default()
    };
    let checks = vec![Solve {
        point,
        figures: runner(&point),
    }];
    let mut table = Table::new(axes, &nodes, checks).unwrap();
    let case = serde_json::json!({ "runner": "a \"round\" & <steep> one", "radius_m": "inf" });
    table.case = case.to_string();
    table.origin = Origin::new("0.1.0".into(), "0123abcd".repeat(8)).unwrap();
    table.interpolation_requested = Some(0.01);
    table
}

/// A contact that slides, by formulas that bend along every axis: a film's law that grows with
/// speed and cold, and a groove.
pub fn slid(point: &Point) -> Figures {
    let speed = point.speed.unwrap_or(20.0);
    let cold = -point.ice_c.unwrap_or(-5.0);
    let hardness = 1e6 * (14.7 + 0.6 * cold);
    let groove_depth = 2e-4 * (point.fz / hardness).sqrt() / (1.0 - 8.0 * point.curvature);
    let mu_ploughing = 12.0 * groove_depth;
    let mu_viscous = 1.1e-3 * (speed.sqrt() * 0.5 + cold / speed) * (point.fz / 1000.0).powf(-0.2);
    let mu_boundary = 2e-3 * (-0.1 * speed).exp();
    let mu = mu_ploughing + mu_viscous + mu_boundary;
    runner(point)
        .with(Quantity::PMax, hardness)
        .with_error(Quantity::PMax, 1e-3 * hardness)
        .with(Quantity::Mu, mu)
        .with_error(Quantity::Mu, 1e-4 * mu)
        .with(Quantity::MuPloughing, mu_ploughing)
        .with(Quantity::MuViscous, mu_viscous)
        .with(Quantity::MuBoundary, mu_boundary)
        .with(Quantity::GrooveDepth, groove_depth)
        .with(Quantity::FilmMean, 1e-7 * speed.sqrt())
}

/// A table over speeds and temperatures too, with or without a rocker axis.
pub fn sliding(rocker: bool) -> Table {
    let axes = Axes::new(
        vec![200.0, 500.0, 1300.0, 3000.0, 8000.0],
        vec![-0.02, 0.0, 0.01, 0.02],
    );
    let axes = with_rocker(axes.unwrap(), rocker)
        .with(AxisKind::Speed, vec![2.0, 6.0, 14.0, 25.0, 40.0])
        .and_then(|axes| axes.with(AxisKind::IceTemperature, vec![-12.0, -7.0, -3.0, -1.0]))
        .unwrap();
    let nodes: Vec<Figures> = axes.points().iter().map(slid).collect();
    let point = Point {
        fz: 777.0,
        curvature: 0.015,
        rocker_radius: rocker.then_some(22.0),
        speed: Some(9.0),
        ice_c: Some(-4.0),
    };
    let checks = vec![Solve {
        point,
        figures: slid(&point),
    }];
    Table::new(axes, &nodes, checks).unwrap()
}
