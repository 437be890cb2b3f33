//! Columns `x_NAME` of an index are candidates from run to run.

use kufe_discover::Verdict;
use kufe_sled::Run;

use crate::campaign::{driven, plan, searched, truth};

/// Runs on two sets of runners in turn, the second of which may have more friction.
fn on_two_sets(more_friction: f64) -> Vec<Run> {
    let plan = plan(7);
    let mut recorded = driven(&plan, &truth(""));
    let mut base = truth("");
    *base.friction.longitudinal.mu.as_mut().unwrap() += more_friction;
    let rough = driven(&plan, &base);
    for (k, (run, rough)) in recorded.iter_mut().zip(rough).enumerate() {
        let set = if k % 2 == 1 { "new" } else { "old" };
        if set == "new" {
            *run = rough;
        }
        let (x, words) = (run.entry.session.len() + k * k % 5, ["wax", "none", "oil"]);
        run.entry.covariates = [
            ("x_runners", set.to_owned()),
            ("x_start_order", x.to_string()),
            ("x_cover", words[k * k % 3].to_owned()),
        ]
        .map(|(name, cell)| (name.to_owned(), cell))
        .into();
    }
    recorded
}

#[test]
fn friction_that_differs_between_sets_of_runners_is_found_as_their_column() {
    let found = searched(&on_two_sets(1.0e-3), 7).report;
    let first = found.steps.first().unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(first.effect, "unknown:x_runners=old", "{found:?}");
    // One standard deviation of an indicator of half the runs is a half: a half of the difference.
    let size = first.parameters[0].value;
    assert!((-0.65e-3..-0.35e-3).contains(&size), "{size}");
}

#[test]
fn sets_of_runners_that_do_not_differ_are_not_found() {
    let found = searched(&on_two_sets(0.0), 7).report;
    assert_eq!(found.verdict, Verdict::None, "{found:?}");
}
