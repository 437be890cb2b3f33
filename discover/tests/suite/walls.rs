//! Contacts with walls that differ from run to run.

use std::collections::BTreeMap;

use kufe_discover::{Options, Rules, Verdict, runs};
use kufe_sled::sample_data::{drive_sample, sample_plan};
use kufe_sled::{Model, PrepareOptions, Vehicle, WallContact, prepare_all, residuals};

/// Sample runs on one track with its walls, for comparison with the true contacts: every second run
/// of the drivers with more than a few.
#[test]
#[ignore = "slow study: .ci/slow"]
fn walls_are_one_effect_with_a_force_per_run_and_in_the_next_model() {
    let base = Model::published();
    let mut plan = sample_plan(2);
    plan.retain(|planned| planned.track == "east" && !planned.run.starts_with('C'));
    let mut place = 0..;
    plan.retain(|_| place.next().is_some_and(|k: usize| k.is_multiple_of(2)));
    for planned in &mut plan {
        planned.options.rate_hz = 100.0;
        planned.options.step_s = 2.5e-3;
        // One bumper: the sample's own contacts act anywhere along the sled.
        for contact in &mut planned.options.contacts {
            contact.x_m = 0.3;
        }
    }
    let recorded = drive_sample(&plan, &base).unwrap();
    let data = runs::prepare(&recorded, &base, &BTreeMap::new(), &Rules::default()).unwrap();
    let options = Options {
        twins: 16,
        flips: 999,
        ..Options::default()
    };
    let found = runs::search(&data, &base, &options, &|_| {}).unwrap();
    let report = &found.report;
    let names: Vec<&str> = report.steps.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(names, ["wall-contact"], "{}", report.sentence);
    assert_eq!(report.verdict, Verdict::Named);
    assert!(report.clean, "{:?}", report.bins_after.first());

    let driven: BTreeMap<&str, &[WallContact]> = plan
        .iter()
        .map(|p| (p.run.as_str(), p.options.contacts.as_slice()))
        .collect();
    let mut reported = 0;
    for own in report.steps[0]
        .contacts
        .iter()
        .flat_map(|place| &place.contacts)
    {
        let middle = 0.5 * (own.from_m + own.to_m);
        let true_one = driven[own.run.as_str()]
            .iter()
            .find(|c| (middle - c.s_m - 0.5 * c.length_m).abs() < 4.0)
            .unwrap_or_else(|| {
                panic!(
                    "{} hit nothing at {middle:.0} m, where the report has {:.0} +- {:.0} N",
                    own.run, own.force_n, own.error_n
                )
            });
        // The low pass of 16 Hz reduces half a wave of 10 m at 28 m/s by a tenth; each force has
        // its standard error.
        let share = own.force_n / true_one.force_n;
        let known = 3.0 * own.error_n / true_one.force_n.abs();
        assert!(
            (0.8 - known..1.1 + known).contains(&share),
            "{} at {middle:.0} m: {share} +- {known}",
            own.run
        );
        reported += 1;
    }
    let all: usize = driven.values().map(|contacts| contacts.len()).sum();
    assert!(reported * 100 >= 95 * all, "{reported} of {all}");

    // Held-out runs, by the commands' own balances: contacts are set by the lateral one and tested
    // by the yaw one.
    let next = Model::from_toml(found.next_model.as_deref().unwrap(), "next").unwrap();
    let locked = &report.held_out.runs;
    let held_out: Vec<_> = recorded
        .into_iter()
        .filter(|run| locked.contains(&run.entry.run))
        .collect();
    let squares = |model: &Model| -> [f64; 2] {
        let vehicle = Vehicle::with_effects(model).unwrap();
        let options = PrepareOptions::default();
        let prepared = prepare_all(&held_out, &vehicle, None, &options).unwrap();
        let all: Vec<_> = prepared
            .iter()
            .flat_map(|run| residuals(run, &vehicle))
            .collect();
        let sum = |of: fn(&kufe_sled::BalanceResidual) -> f64| {
            all.iter().map(|l| of(l).powi(2)).sum::<f64>()
        };
        [sum(|l| l.side_n), sum(|l| l.yaw_nm)]
    };
    let ([side, yaw], [side_next, yaw_next]) = (squares(&base), squares(&next));
    // An accelerometer's 0.2 m/s2 through 20 Hz is 50 N, 27 % of the squares with hits of 500 to
    // 1100 N; the rest is the error of the half wave.
    assert!(side_next < 0.35 * side, "{side_next} of {side}");
    // So is most of the moment, which sets no contact: 150 to 330 N m.
    assert!(yaw_next < 0.5 * yaw, "{yaw_next} of {yaw}");
    let lever = &report.steps[0].parameters[0];
    assert!((lever.value - 0.3).abs() < 0.03, "{lever:?}");
    let [before, after] = [report.held_out.gap_before, report.held_out.gap_after];
    assert!(after < before && report.held_out.unit == "N m");
}
