//! Scores of groups of runs: drivers, classes, tracks.

use serde::Serialize;

use crate::evaluate::bootstrap::{Summary, summarise};
use crate::evaluate::driving::RunEvaluation;

/// Scores of a group of runs, each with its interval over runs.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// What the runs share: `driver`, `class` or `track`.
    pub by: &'static str,
    /// Its name.
    pub name: String,
    /// The track, where only its runs count.
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

/// Groups by driver and by class, on each track and over all, and by track; in the order of first appearance.
pub fn groups(runs: &[RunEvaluation], seed: u64) -> Vec<Group> {
    let tracks = distinct(runs, |run| &run.track);
    let mut places: Vec<Option<&str>> = vec![None];
    if tracks.len() > 1 {
        places.extend(tracks.iter().map(|track| Some(*track)));
    }
    let mut groups = Vec::new();
    for place in places {
        let here: Vec<&RunEvaluation> = runs
            .iter()
            .filter(|run| place.is_none_or(|track| run.track == track))
            .collect();
        for (by, key) in [
            (
                "driver",
                (|run| &run.driver) as fn(&RunEvaluation) -> &String,
            ),
            ("class", |run| &run.driver_class),
        ] {
            for name in distinct(runs, key) {
                let of: Vec<&RunEvaluation> = here
                    .iter()
                    .copied()
                    .filter(|run| key(run) == name)
                    .collect();
                groups.extend(group(by, name, place, &of, seed));
            }
        }
    }
    for track in tracks {
        let of: Vec<&RunEvaluation> = runs.iter().filter(|run| run.track == track).collect();
        groups.extend(group("track", track, None, &of, seed));
    }
    groups
}

/// Names in the order of their first run.
pub fn distinct(runs: &[RunEvaluation], key: fn(&RunEvaluation) -> &String) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for run in runs {
        let name = key(run).as_str();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn group(
    by: &'static str,
    name: &str,
    track: Option<&str>,
    runs: &[&RunEvaluation],
    seed: u64,
) -> Option<Group> {
    if runs.is_empty() {
        return None;
    }
    let of = |pick: fn(&RunEvaluation) -> f64| {
        let values: Vec<f64> = runs.iter().map(|run| pick(run)).collect();
        summarise(&values, seed)
    };
    Some(Group {
        by,
        name: name.to_string(),
        track: track.map(str::to_string),
        runs: runs.len(),
        increase_front: of(|run| run.increase_front),
        increase_rear: of(|run| run.increase_rear),
        increase_aero: of(|run| run.increase_aero),
        increase_total: of(|run| run.increase_total),
        steering_above_2deg: of(|run| run.steering.share_above_2deg),
        steering_above_4deg: of(|run| run.steering.share_above_4deg),
        slip_front_above_2deg: of(|run| run.slip_front.share_above_2deg),
        slip_rear_above_2deg: of(|run| run.slip_rear.share_above_2deg),
    })
}
