//! Campaigns of the sample sled and tracks, simulated with effects that the published model does
//! not contain.

use std::collections::BTreeMap;

use kufe_discover::{Found, Options, Rules, runs};
use kufe_sled::sample_data::{Planned, drive_sample, sample_plan, sample_track};
use kufe_sled::{Model, Run};

/// The published model with `hidden` (TOML).
pub fn truth(hidden: &str) -> Model {
    Model::from_toml(&(Model::published().to_toml() + hidden), "truth").unwrap()
}

/// Runs without walls, at the quick rate of tests.
pub fn plan(seed: u64) -> Vec<Planned> {
    let mut plan = sample_plan(seed);
    for planned in &mut plan {
        planned.options.rate_hz = 100.0;
        planned.options.step_s = 2.5e-3;
        planned.options.contacts.clear();
    }
    plan
}

/// The runs of a plan.
pub fn driven(plan: &[Planned], truth: &Model) -> Vec<Run> {
    drive_sample(plan, truth).unwrap()
}

/// The result of a search of the published model in runs, with the tracks of the runs.
pub fn searched(recorded: &[Run], seed: u64) -> Found {
    let tracks = ["east", "west"].map(sample_track);
    let slopes = |k: usize| -> Vec<(f64, f64)> {
        let track = &tracks[k];
        track
            .s_m
            .iter()
            .copied()
            .zip(track.slope_rad.iter().copied())
            .collect()
    };
    let surveys = BTreeMap::from([
        ("east".to_owned(), slopes(0)),
        ("west".to_owned(), slopes(1)),
    ]);
    let base = Model::published();
    let mut data = runs::prepare(recorded, &base, &surveys, &Rules::default()).unwrap();
    data.tracks = tracks.to_vec();
    let options = Options {
        twins: 16,
        flips: 999,
        seed,
        ..Options::default()
    };
    runs::search(&data, &base, &options, &|_| {}).unwrap()
}
