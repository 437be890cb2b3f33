//! What of the runs took part in a result, in numbers and in a line.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::record::check::gaps::Gaps;

/// What of one run took part in a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TakingPart {
    /// Name of the run.
    pub run: String,
    /// What is not there.
    #[serde(flatten)]
    pub gaps: Gaps,
    /// Stretches that take part.
    pub stretches: usize,
    /// Time that takes part [s].
    pub used_s: f64,
    /// Time from the first sample to the last [s].
    pub of_s: f64,
}

/// One line on all runs with gaps; empty where there are none.
pub fn gaps_line(runs: &[TakingPart]) -> String {
    let (Some(first), sum) = (runs.first(), |of: &dyn Fn(&TakingPart) -> f64| -> f64 {
        runs.iter().map(of).sum()
    }) else {
        return String::new();
    };
    let mut parts = Vec::new();
    let mut count = |of: &dyn Fn(&Gaps) -> usize, what: &str| {
        let all: usize = runs.iter().map(|run| of(&run.gaps)).sum();
        if all > 0 {
            parts.push(format!("{all} {what}"));
        }
    };
    count(&|gaps| gaps.rows_missing, "rows missing");
    let columns: BTreeSet<&String> = runs
        .iter()
        .flat_map(|run| run.gaps.missing.keys())
        .collect();
    for column in columns {
        let values = |gaps: &Gaps| gaps.missing.get(column).copied().unwrap_or(0);
        count(&values, &format!("values of {column} missing"));
    }
    count(&|gaps| gaps.standstill, "samples at standstill");
    let cut = sum(&|run| run.gaps.cut_s.iter().sum());
    if cut > 0.0 {
        parts.push(format!("{cut:.2} s cut off at starts and ends"));
    }
    let jitter = runs.iter().map(|run| run.gaps.jitter).fold(0.0, f64::max);
    if jitter > 0.0 {
        let share = 100.0 * jitter;
        parts.push(format!(
            "rows up to {share:.0} % of a step off, brought to even steps"
        ));
    }
    let who = match runs.len() {
        1 => format!("run {}", first.run),
        many => format!("{many} runs with gaps"),
    };
    let (used, of) = (sum(&|run| run.used_s), sum(&|run| run.of_s));
    let parts = parts.join(", ");
    format!("{who}: {parts}; {used:.1} s of {of:.1} s take part (--strict refuses such runs)")
}
