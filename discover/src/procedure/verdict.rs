//! The outcome: its verdict and what to measure next.

use kufe_plot::number4;

use crate::finding::next_runs::NextRuns;
use crate::finding::report::Verdict;
use crate::procedure::evidence::{Account, Description};

/// The outcome in one word.
pub fn verdict(account: &Account, located: bool) -> Verdict {
    match account.steps.first() {
        Some(_) if !account.depends.is_empty() && account.steps.len() == 1 => Verdict::DependsOn,
        Some(step) if step.law.is_some() => Verdict::Law,
        Some(step) if step.class.len() == 1 => Verdict::Named,
        Some(_) => Verdict::OneOf,
        None if account.unexplained.is_some() => Verdict::NotIdentifiable,
        None if located => Verdict::Located,
        None => Verdict::None,
    }
}

/// What to measure next.
pub fn next_experiment(verdict: Verdict, account: &Account, described: &Description) -> String {
    let words = &described.words;
    match verdict {
        Verdict::NotIdentifiable => account.unexplained.clone().unwrap_or_default(),
        Verdict::DependsOn => "a survey of the track's slope with a stated deviation".to_owned(),
        Verdict::Located => {
            "runs in which the bins listed are visited with other variables changed".to_owned()
        }
        Verdict::None => words.next_after_nothing.clone(),
        Verdict::Named if !words.next_after_name.is_empty() => words.next_after_name.clone(),
        Verdict::Law => {
            let of_laws = account.steps.iter().filter(|s| s.law.is_some());
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
            let planned = planned(&described.next_runs).into_iter();
            planned.chain(what).collect::<Vec<_>>().join("; ")
        }
    }
}

/// The best of the planned runs beside the rest.
fn planned(plans: &[NextRuns]) -> Option<String> {
    let (best, last) = (plans.first()?, plans.last()?);
    let [a, b] = &best.between;
    /// Less is no difference but rounding.
    const NOTHING: f64 = 1e-6;
    if best.expected_evidence < NOTHING {
        return Some(format!(
            "no runs tell {a} from {b}: simulated, they are the same in all {} plans tried",
            plans.len()
        ));
    }
    Some(match best.splits {
        true => format!(
            "{} runs on {}, {}, would tell {a} from {b} (by simulating them: expected logarithm of the likelihood ratio {}, {} plans tried, the least {})",
            best.runs,
            best.track,
            best.change,
            number4(best.expected_evidence),
            plans.len(),
            number4(last.expected_evidence)
        ),
        false => format!(
            "none of {} plans for {} runs, simulated, tells {a} from {b}: most by runs on {}, {}, an expected logarithm of the likelihood ratio of {}",
            plans.len(),
            best.runs,
            best.track,
            best.change,
            number4(best.expected_evidence)
        ),
    })
}
