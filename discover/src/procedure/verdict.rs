//! The verdict and what to measure next.

use kufe::plot::number4;

use crate::finding::NextRuns;
use crate::finding::{Bin, Verdict};
use crate::procedure::evidence::{Account, Description};

/// The verdict of a search.
pub fn verdict(account: &Account, located: bool, adequate: bool) -> Verdict {
    match account.steps.first() {
        // Each assumption is about one step.
        Some(_) if account.depends.len() >= account.steps.len() => Verdict::DependsOn,
        Some(step) if step.law.is_some() => Verdict::Law,
        Some(step) if step.class.len() == 1 => Verdict::Named,
        Some(_) => Verdict::OneOf,
        None if account.unexplained.is_some() => Verdict::NotIdentifiable,
        None if located => Verdict::Located,
        None if !adequate => Verdict::Inadequate,
        None => Verdict::None,
    }
}

/// What to check and to measure next.
pub fn next_experiment(verdict: Verdict, account: &Account, described: &Description) -> String {
    /// Largest number of installation errors to check; further ones usually follow from these.
    const MAX_CHECKED: usize = 3;
    let mut outside = account.outside_tolerance.clone();
    outside.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let names = outside.into_iter().take(MAX_CHECKED).map(|(what, _)| what);
    let outside = names.collect::<Vec<_>>().join(", ");
    let check = (!outside.is_empty()).then(|| {
        format!("a check of the installation errors that exceed their tolerance most: {outside}")
    });
    let measured = Some(measurement(verdict, account, described)).filter(|what| !what.is_empty());
    let both: Vec<String> = check.into_iter().chain(measured).collect();
    both.join("; ")
}

/// The next measurement, in words.
fn measurement(verdict: Verdict, account: &Account, described: &Description) -> String {
    let report = &described.report;
    let meaning = |name: &String| described.effects.iter().find(|e| e.name == *name);
    match verdict {
        Verdict::DependsOn => {
            let mut what: Vec<&str> = account.depends.iter().map(|d| d.decides.as_str()).collect();
            what.dedup();
            what.join("; ")
        }
        Verdict::Located => {
            let bin = |b: &Bin| format!("{} {} to {}", b.column, number4(b.from), number4(b.to));
            let places: Vec<String> = report.bins_after.iter().take(3).map(bin).collect();
            format!(
                "two runs that pass {} with a tenth less speed, and two with a tenth more mass",
                places.join(", ")
            )
        }
        Verdict::Inadequate => {
            let places = report.remaining.iter().filter(|r| !r.is_small);
            let places: Vec<&str> = places.flat_map(|r| &r.places).map(String::as_str).collect();
            format!(
                "two more runs that take these places on another line or at another speed, and a check of the sensors at rest before and after: {}",
                places.join("; ")
            )
        }
        Verdict::NotIdentifiable | Verdict::None => {
            let known = account.unexplained.as_ref().map(|one| &one.decides);
            let known = known.filter(|decides| !decides.is_empty());
            known.unwrap_or(&described.next_after_nothing).clone()
        }
        Verdict::Law => {
            let of_laws = account.steps.iter().filter(|s| s.law.is_some());
            let members = of_laws.flat_map(|s| &s.class);
            let known = members.clone().filter_map(meaning);
            let decides: Vec<&str> = known.map(|e| e.decides.as_str()).collect();
            if !decides.is_empty() {
                return decides.join("; ");
            }
            let columns: Vec<&str> = members.filter_map(|c| c.strip_prefix("unknown:")).collect();
            format!(
                "runs in which {} is varied by itself",
                columns.join(", or ").replace('*', " and ")
            )
        }
        Verdict::Named | Verdict::OneOf => {
            let classes = account.steps.iter().map(|s| &s.class);
            let split = classes.filter(|class| verdict == Verdict::Named || class.len() > 1);
            let members = split.flatten().filter_map(meaning);
            let decides = members.map(|e| format!("{}: {}", e.name, e.decides));
            let mut what: Vec<String> = planned(&report.next_runs).into_iter().collect();
            what.extend(decides);
            what.dedup();
            what.join("; ")
        }
    }
}

/// The best of the planned runs, in words.
fn planned(plans: &[NextRuns]) -> Option<String> {
    /// Smaller evidence is rounding.
    const NOTHING: f64 = 1e-6;
    let best = plans.first()?;
    let ([a, b], tried) = (&best.between, plans.len());
    let (runs, track, change) = (best.runs, &best.track, &best.change);
    Some(if best.expected_evidence < NOTHING {
        format!("no runs, since {a} and {b} agree in all {tried} simulated plans")
    } else if best.splits {
        format!(
            "{runs} runs on {track}, {change}, would distinguish {a} from {b}: the best of {tried} simulated plans"
        )
    } else {
        format!(
            "{runs} runs on {track}, {change}: the best of {tried} simulated plans, but not enough to distinguish {a} from {b}"
        )
    })
}
