//! Scores of groups of runs: drivers, classes, tracks.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::evaluate::driving::RunEvaluation;
use crate::series::distinct;

/// Scores of a group of runs, each with its interval over runs.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Group {
    /// Criterion of the group: `driver`, `class` or `track`.
    pub by: String,
    /// Name of the driver, class or track.
    pub name: String,
    /// The track to which the group is limited; `None` for all tracks.
    pub track: Option<String>,
    /// Number of runs.
    pub runs: usize,
    /// Relative increase at the front runner.
    pub increase_front: Summary,
    /// Relative increase at the rear runner.
    pub increase_rear: Summary,
    /// Relative increase of the air's drag.
    pub increase_aero: Summary,
    /// The score.
    pub increase_total: Summary,
    /// Share of steering above 2 degrees.
    pub steering_above_2deg: Summary,
    /// Share of steering above 4 degrees.
    pub steering_above_4deg: Summary,
    /// Share of front slip above 2 degrees.
    pub slip_front_above_2deg: Summary,
    /// Share of rear slip above 2 degrees.
    pub slip_rear_above_2deg: Summary,
}

/// Groups by driver and by class, over all tracks and on each, and groups by track; in the order of
/// first appearance.
pub fn groups(runs: &[RunEvaluation], seed: u64) -> Vec<Group> {
    let tracks = distinct(runs.iter().map(|run| run.track.as_str()));
    let mut places: Vec<Option<&str>> = vec![None];
    if tracks.len() > 1 {
        places.extend(tracks.iter().copied().map(Some));
    }
    let keys: [(&str, Key); 2] = [
        ("driver", |run| &run.driver),
        ("class", |run| &run.driver_class),
    ];
    let mut groups = Vec::new();
    for place in places {
        let is_here = |run: &&RunEvaluation| place.is_none_or(|track| run.track == track);
        for (by, key) in keys {
            for name in distinct(runs.iter().map(key)) {
                let members = runs.iter().filter(is_here).filter(|run| key(run) == name);
                groups.extend(group(by, name, place, members.collect(), seed));
            }
        }
    }
    for track in tracks {
        let members = runs.iter().filter(|run| run.track == track);
        groups.extend(group("track", track, None, members.collect(), seed));
    }
    groups
}

/// The key of a group.
type Key = fn(&RunEvaluation) -> &String;

fn group(
    by: &str,
    name: &str,
    track: Option<&str>,
    runs: Vec<&RunEvaluation>,
    seed: u64,
) -> Option<Group> {
    if runs.is_empty() {
        return None;
    }
    let summary = |pick: fn(&RunEvaluation) -> f64| {
        let values: Vec<f64> = runs.iter().map(|run| pick(run)).collect();
        summarise(&values, seed)
    };
    Some(Group {
        by: by.to_owned(),
        name: name.to_string(),
        track: track.map(str::to_string),
        runs: runs.len(),
        increase_front: summary(|run| run.increase_front),
        increase_rear: summary(|run| run.increase_rear),
        increase_aero: summary(|run| run.increase_aero),
        increase_total: summary(|run| run.increase_total),
        steering_above_2deg: summary(|run| run.steering.share_above_2deg),
        steering_above_4deg: summary(|run| run.steering.share_above_4deg),
        slip_front_above_2deg: summary(|run| run.slip_front.share_above_2deg),
        slip_rear_above_2deg: summary(|run| run.slip_rear.share_above_2deg),
    })
}

/// Mean, median and a 95 % interval of the mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Summary {
    /// Arithmetic mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Lower end of the mean's interval; `None` for a single value.
    pub low: Option<f64>,
    /// Upper end of the mean's interval; `None` for a single value.
    pub high: Option<f64>,
}

/// Number of bootstrap resamples.
const RESAMPLES: usize = 4000;

/// Summarises values, one per run, with a percentile bootstrap over runs.
///
/// Resampled means have `(n-1)/n` of the variance of the mean; their spread is therefore multiplied
/// by `sqrt(n/(n-1))`. With fewer than about eight runs the interval is still too narrow. The same
/// seed gives the same interval.
///
/// # Panics
/// Panics without values.
fn summarise(values: &[f64], seed: u64) -> Summary {
    assert!(!values.is_empty(), "no values to summarise");
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut summary = Summary {
        mean,
        median: quantile(&sorted, 0.5),
        low: None,
        high: None,
    };
    if n < 2 {
        return summary;
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let wider = (n as f64 / (n - 1) as f64).sqrt();
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let sum: f64 = (0..n).map(|_| values[random.random_range(0..n)]).sum();
            mean + wider * (sum / n as f64 - mean)
        })
        .collect();
    means.sort_by(f64::total_cmp);
    summary.low = Some(quantile(&means, 0.025));
    summary.high = Some(quantile(&means, 0.975));
    summary
}

/// Quantile of sorted values at the probability `share`, linear between order statistics.
///
/// # Panics
/// Panics without values.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let position = share.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let low = position as usize;
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] + (position - low as f64) * (sorted[high] - sorted[low])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn intervals_cover_the_mean_nineteen_times_in_twenty() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let trials = 400;
        let covered = (0..trials)
            .filter(|trial| {
                let values: Vec<f64> = (0..20)
                    .map(|_| StandardNormal.sample(&mut random))
                    .collect();
                let summary = summarise(&values, *trial);
                summary.low.unwrap() <= 0.0 && 0.0 <= summary.high.unwrap()
            })
            .count();
        let share = covered as f64 / trials as f64;
        // Three standard errors of a share of 0.95 among 400 are 0.033.
        assert!((0.915..=0.98).contains(&share), "covered {share}");
    }

    #[test]
    fn one_run_has_no_interval() {
        let summary = summarise(&[2.0], 1);
        assert_eq!((summary.mean, summary.low, summary.high), (2.0, None, None));
    }
}
