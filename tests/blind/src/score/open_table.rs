//! The table of the open worlds: counts by family and case, with binomial intervals.

use std::fmt::Write as _;

use crate::score::outcome::{Fresh, OnRun, Outcome};
use crate::score::table::grouped;

/// Wilson's 95 % interval of a share: `k` of `n`.
///
/// ```text
/// (p + z^2/2n -+ z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n),   p = k/n, z = 1.96
/// ```
///
/// E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209. The whole range where n = 0.
pub fn wilson(k: usize, n: usize) -> [f64; 2] {
    if n == 0 {
        return [0.0, 1.0];
    }
    let (z, n) = (1.959_964, n as f64);
    let p = k as f64 / n;
    let middle = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + z * z / n;
    [
        ((middle - half) / whole).max(0.0),
        ((middle + half) / whole).min(1.0),
    ]
}

/// Whether a model is worse than another on the same runs: in one of along, side and yaw force, time
/// and speed, or in the last two alone, the mean over the runs is larger by 2 %, and by more than
/// twice the standard error of the runs' differences. No model is worse than any.
pub fn is_worse(model: &[OnRun], than: &[OnRun], replay_alone: bool) -> bool {
    if model.len() != than.len() || model.is_empty() {
        return true;
    }
    let all = |run: &OnRun| [run.force.as_slice(), run.replay.as_slice()].concat();
    let n = model.len() as f64;
    let first = if replay_alone { 3 } else { 0 };
    (first..5).any(|k| {
        let reference = than.iter().map(|run| all(run)[k]).sum::<f64>() / n;
        let more: Vec<f64> = model
            .iter()
            .zip(than)
            .map(|(a, b)| all(a)[k] - all(b)[k])
            .collect();
        let mean = more.iter().sum::<f64>() / n;
        let squares = more.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let error = (squares / ((n - 1.0).max(1.0) * n)).sqrt();
        mean > 0.02 * reference && mean > 2.0 * error
    })
}

/// Median of some numbers, as text.
fn median(mut values: Vec<f64>, digits: usize) -> String {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => "-".to_owned(),
        _ => format!("{:.digits$}", 0.5 * (values[(n - 1) / 2] + values[n / 2])),
    }
}

/// `k of n (low to high %)`.
fn counted(yes: impl Iterator<Item = bool>) -> String {
    let (mut k, mut n) = (0, 0);
    for is in yes {
        n += 1;
        k += usize::from(is);
    }
    let [low, high] = wilson(k, n).map(|share| 100.0 * share);
    match n {
        0 => "-".to_owned(),
        _ => format!("{k} of {n} ({low:.0} to {high:.0} %)"),
    }
}

/// The table of those outcomes that are of open worlds; empty where there are none.
pub fn open_table(outcomes: &[Outcome]) -> String {
    let open: Vec<Outcome> = outcomes
        .iter()
        .filter(|o| o.family.starts_with("open-"))
        .cloned()
        .collect();
    if open.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\nOpen worlds: k of n, 95 % intervals by Wilson\n\n\
         | case | no answer | wrong firm names | found in class | median class | firm names of a \
         cause beyond | cause flagged | worse than refitted | in the replay | worse than given | in \
         the replay | s | CPU s: median, most |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (id, of) in grouped(&open, |o| o.id.clone()) {
        let answers: Vec<&Outcome> = of.iter().copied().filter(|o| o.failure.is_none()).collect();
        let answers = &answers;
        let found = answers
            .iter()
            .flat_map(|o| &o.found)
            .filter(|f| !is_beyond(&f.effect));
        let class = found.clone().filter_map(|f| f.class_size.map(|n| n as f64));
        let of_causes = || {
            answers
                .iter()
                .filter(|o| o.found.iter().any(|f| is_beyond(&f.effect)))
        };
        let fresh = |worse: fn(&Fresh) -> bool| {
            counted(answers.iter().filter_map(|o| o.fresh.as_ref()).map(worse))
        };
        let cpu: Vec<f64> = of.iter().filter_map(|o| o.cpu_seconds).collect();
        let most = cpu.iter().fold(0.0_f64, |most, s| most.max(*s));
        let _ = writeln!(
            text,
            "| {id} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {}, {most:.0} |",
            counted(of.iter().map(|o| o.failure.is_some())),
            counted(answers.iter().map(|o| o.wrong_firm)),
            counted(found.clone().map(|f| f.in_class)),
            median(class.collect(), 1),
            counted(
                of_causes().map(|o| o.claims.iter().any(|c| is_firm(&c.effect, c.class.len())))
            ),
            counted(of_causes().map(|o| is_flagged(o))),
            fresh(|fresh| is_worse(&fresh.written, &fresh.refitted, false)),
            fresh(|fresh| is_worse(&fresh.written, &fresh.refitted, true)),
            fresh(|fresh| is_worse(&fresh.written, &fresh.given, false)),
            fresh(|fresh| is_worse(&fresh.written, &fresh.given, true)),
            median(of.iter().map(|o| o.seconds).collect(), 0),
            median(cpu, 0),
        );
    }
    text
}

/// Whether neither an effect of the catalogue nor a law of a column can represent a hidden thing.
fn is_beyond(effect: &str) -> bool {
    effect.starts_with("beyond:")
}

fn is_firm(effect: &str, class_size: usize) -> bool {
    class_size == 1 && !effect.starts_with("unknown:")
}

/// Whether the report states that more is wrong than it names.
fn is_flagged(outcome: &Outcome) -> bool {
    outcome.adequate == Some(false) || ["located", "inadequate"].contains(&outcome.verdict.as_str())
}
