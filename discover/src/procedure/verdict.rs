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

/// What to measure next.
pub fn next_experiment(verdict: Verdict, account: &Account, described: &Description) -> String {
    match verdict {
        Verdict::NotIdentifiable => account.unexplained.clone().unwrap_or_default(),
        Verdict::DependsOn => {
            let mut what: Vec<&str> = account.depends.iter().map(|d| d.decides.as_str()).collect();
            what.dedup();
            what.join("; ")
        }
        Verdict::Located => {
            let bin = |b: &Bin| format!("{} {} to {}", b.column, number4(b.from), number4(b.to));
            let places: Vec<String> = described
                .report
                .bins_after
                .iter()
                .take(3)
                .map(bin)
                .collect();
            format!(
                "two runs that pass {} with a tenth less speed, and two with a tenth more mass",
                places.join(", ")
            )
        }
        Verdict::Inadequate => {
            let places = described.report.remaining.iter().filter(|r| !r.is_small);
            let places: Vec<&str> = places.flat_map(|r| &r.places).map(String::as_str).collect();
            format!(
                "two more runs that take these places on another line or at another speed, and a check of the sensors at rest before and after: {}",
                places.join("; ")
            )
        }
        Verdict::None => described.next_after_nothing.clone(),
        Verdict::Law => {
            let of_laws = account.steps.iter().filter(|s| s.law.is_some());
            let known = of_laws.clone().flat_map(|s| s.class.iter());
            let known = known.filter_map(|c| described.effects.iter().find(|e| e.name == *c));
            let decides: Vec<&str> = known.map(|e| e.decides.as_str()).collect();
            if !decides.is_empty() {
                return decides.join("; ");
            }
            let columns = of_laws.flat_map(|s| s.class.iter());
            let columns: Vec<&str> = columns.filter_map(|c| c.strip_prefix("unknown:")).collect();
            format!(
                "runs in which {} is varied by itself",
                columns.join(", or ").replace('*', " and ")
            )
        }
        Verdict::Named | Verdict::OneOf => {
            let split = |class: &[String]| verdict == Verdict::Named || class.len() > 1;
            let mut what: Vec<String> = account
                .steps
                .iter()
                .filter(|s| split(&s.class))
                .flat_map(|s| &s.class)
                .filter_map(|name| described.effects.iter().find(|e| e.name == *name))
                .map(|e| format!("{}: {}", e.name, e.decides))
                .collect();
            what.dedup();
            let planned = planned(&described.report.next_runs).into_iter();
            planned.chain(what).collect::<Vec<_>>().join("; ")
        }
    }
}

/// The best of the planned runs, in words.
fn planned(plans: &[NextRuns]) -> Option<String> {
    let best = plans.first()?;
    let [a, b] = &best.between;
    /// Smaller evidence is rounding.
    const NOTHING: f64 = 1e-6;
    if best.expected_evidence < NOTHING {
        return Some(format!(
            "no runs distinguish {a} from {b}: their simulations agree in all {} plans tried",
            plans.len()
        ));
    }
    let NextRuns {
        runs,
        track,
        change,
        ..
    } = best;
    let tried = plans.len();
    Some(match best.splits {
        true => format!(
            "{runs} runs on {track}, {change}, would distinguish {a} from {b}: the best of {tried} simulated plans"
        ),
        false => format!(
            "none of {tried} simulated plans, of {runs} runs each, distinguishes {a} from {b}; runs on {track}, {change}, come nearest"
        ),
    })
}
