//! A misaligned inertial unit must bias neither friction nor the written model.

use kufe_discover::{Found, ModelKind};
use kufe_sled::Model;

use crate::campaign::{driven, plan, searched, truth};

/// Runs of the published sled, sixteen of all sessions, with `hidden` (TOML), searched with the published model.
fn found(hidden: &str, seed: u64) -> Found {
    let plan: Vec<_> = plan(seed).into_iter().step_by(2).take(16).collect();
    searched(&driven(&plan, &truth(hidden)), seed)
}

fn reported(found: &Found) -> String {
    let report = &found.report;
    format!(
        "{}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}",
        report.sentence,
        report.written,
        report.withheld,
        report.base,
        report.baselines,
        report.within_tolerance,
        report.remarks
    )
}

/// The interval of friction covers the truth, and the written friction, that of the replays, is within
/// 5 % of it; no replay is worse than with the given model.
fn friction_is_right(found: &Found) {
    let mu = Model::published().friction.longitudinal.mu.unwrap();
    let base = found.report.base.iter();
    let fitted = base.clone().find(|b| b.name == "longitudinal mu").unwrap();
    println!("{}", reported(found));
    assert!((fitted.low..fitted.high).contains(&mu), "{fitted:?}");
    assert!((fitted.value / mu - 1.0).abs() < 0.05, "{fitted:?}");
    for baseline in &found.report.baselines {
        let written = match found.report.written {
            ModelKind::WithEffect => baseline.with_effect,
            ModelKind::Refitted => baseline.refitted,
            ModelKind::AsGiven => Some(baseline.as_given),
        };
        if let (Some(written), "replay v_mps") = (written, &*baseline.quantity) {
            assert!(written < 1.2 * baseline.as_given + 0.02, "{baseline:?}");
        }
    }
}

#[test]
fn a_box_pitched_by_two_degrees_is_named_and_leaves_friction_alone() {
    let found = found("\n[effects.imu-misalignment]\npitch_rad = 0.035\n", 5);
    friction_is_right(&found);
    let first = found.report.steps.first().expect("a step");
    assert!(
        first.class.iter().any(|name| name == "imu-misalignment"),
        "{:?}",
        first.class
    );
}

#[test]
fn a_box_pitched_within_its_tolerance_leaves_friction_alone_and_is_not_named() {
    let found = found("\n[effects.imu-misalignment]\npitch_rad = 0.0035\n", 6);
    friction_is_right(&found);
    assert!(found.report.steps.is_empty());
}
