//! Sweeps over speed and temperature.

use crate::tables::slid;
use kufe_lut::{AxisKind, Interpolator, Mode, Plan, Point, Quantity, Spacing, sweep};
use std::convert::Infallible;

fn range(from: f64, to: f64) -> Spacing {
    Spacing::Range { from, to }
}

/// Given forces and curvatures, ranges of speed and temperature.
fn plan() -> Plan {
    let fz = vec![300.0, 800.0, 2000.0];
    let mut plan = Plan::new(Spacing::Values(fz), Spacing::Values(vec![0.0, 0.01, 0.02]));
    plan = plan
        .with(AxisKind::Speed, range(2.0, 40.0))
        .with(AxisKind::IceTemperature, range(-12.0, -1.0));
    plan.interpolation = 0.005;
    plan.checks = 60;
    plan
}

#[test]
fn ranges_of_speed_and_temperature_are_refined_until_mu_meets_the_request_at_points_they_never_saw()
{
    let plan = plan();
    let swept = sweep(&plan, |point| Ok::<_, Infallible>(slid(point))).unwrap();
    assert!(swept.shortfall.is_none(), "{:?}", swept.shortfall);
    let axes = swept.table.axes();
    let (speeds, temperatures) = (axes.speed().unwrap(), axes.ice_c().unwrap());
    assert!(speeds.len() > 5 && temperatures.len() >= 5);
    for mode in Mode::ALL {
        let mu = Interpolator::new(&swept.table, Quantity::Mu, mode, None).unwrap();
        // On the given forces and curvatures, whose spacing is measured and not mended.
        for n in 0..500 {
            let t = |step: f64| (0.31 + f64::from(n) * step).fract();
            let point = Point {
                fz: 800.0,
                curvature: 0.01,
                rocker_radius: None,
                speed: Some(2.0 * 20f64.powf(t(0.7548776662466927))),
                ice_c: Some(-12.0 + 11.0 * t(0.5698402909980532)),
            };
            let truth = slid(&point).get(Quantity::Mu).unwrap();
            let error = (mu.at(point).value / truth - 1.0).abs();
            assert!(error <= plan.interpolation, "{mode:?} {point}: {error}");
        }
    }
}
