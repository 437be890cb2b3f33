//! The planned runs of largest expected evidence split the class, those of the smallest do not:
//! both are simulated and searched.

use kufe_discover::{NextRuns, Report, Verdict};
use kufe_sled::Run;
use kufe_sled::sample_data::Planned;

use crate::campaign::{driven, plan, searched, truth};

const HIDDEN: &str = "\n[effects.temperature]\nslope_per_k = 0.04\n";

/// Nine sessions whose humidity is collinear with the ice temperature.
fn tied() -> Vec<Planned> {
    let mut plan = plan(7);
    plan.truncate(27);
    for (k, planned) in plan.iter_mut().enumerate() {
        let session = k / 3;
        planned.session = format!("s{session}");
        let ice_c = -11.0 + 1.1 * ((4 * session) % 9) as f64 + 0.05 * (k % 3) as f64;
        planned.options.conditions.ice_c = ice_c;
        planned.options.conditions.humidity_pct = 60.0 + 3.0 * (ice_c + 6.0);
    }
    plan
}

/// The planned runs, by drivers of the campaign, in a session of their own.
fn planned_runs(next: &NextRuns, like: &[Planned]) -> Vec<Planned> {
    let same = |planned: &&Planned| planned.track == next.track;
    let mut plan: Vec<Planned> = like.iter().filter(same).take(next.runs).cloned().collect();
    assert_eq!(plan.len(), next.runs, "{next:?}");
    for (k, planned) in plan.iter_mut().enumerate() {
        planned.run = format!("new-{k}");
        planned.session = "t".to_owned();
        planned.options.seed = 9000 + k as u64;
        planned.options.start_speed_mps = next.start_speed_mps;
        let conditions = &mut planned.options.conditions;
        conditions.ice_c = next.ice_c;
        conditions.air_c = next.air_c;
        conditions.air_pa = next.air_pa;
        conditions.humidity_pct = next.humidity_pct.unwrap_or(f64::NAN);
        conditions.mass_kg = next.mass_kg;
    }
    plan
}

fn class(report: &Report) -> Vec<String> {
    let of = |name: &str| {
        report
            .steps
            .iter()
            .find(|s| s.class.iter().any(|c| c == name))
    };
    let mut class = of("temperature").map_or(Vec::new(), |step| step.class.clone());
    class.sort();
    class
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn the_best_planned_runs_split_the_class_and_the_worst_do_not() {
    let truth = truth(HIDDEN);
    let before = tied();
    let recorded = driven(&before, &truth);
    let report = searched(&recorded, 7).report;
    assert_eq!(
        class(&report),
        ["humidity", "temperature"],
        "{}",
        report.sentence
    );
    assert_eq!(report.verdict, Verdict::OneOf);
    let plans = &report.next_runs;
    let (best, least) = (&plans[0], &plans[plans.len() - 1]);
    println!("best {best:?}\nleast {least:?}");
    assert!(best.splits && !least.splits);
    assert!(
        report.next_experiment.contains(&best.change),
        "{}",
        report.next_experiment
    );
    let again = |next: &NextRuns| {
        let more: Vec<Run> = driven(&planned_runs(next, &before), &truth);
        let all: Vec<Run> = recorded.iter().cloned().chain(more).collect();
        let report = searched(&all, 7).report;
        println!("{}: {}", next.change, report.sentence);
        class(&report)
    };
    assert_eq!(again(best), ["temperature"]);
    assert_eq!(again(least), ["humidity", "temperature"]);
}
