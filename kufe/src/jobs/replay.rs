//! Replay of a measured run: the model drives it with the recorded inputs.

use std::path::{Path, PathBuf};

use kufe_sled::{
    Entry, Inputs, OutsideTable, Replay, Run, SimulateOptions, Track, TrackShape, Vehicle,
    add_measured_columns, gaps_line, outside_tables, read_for_replay, read_index, record, replay,
};

use crate::jobs::failure::Failure;
use crate::jobs::runs::{load_model, named_run, on_gaps, warn_elsewhere};
use crate::jobs::watch::Watch;
use crate::results::ReplayResult;

/// The replay of a run: model, track, run and options.
#[derive(Clone, Debug)]
pub struct ReplayedDrive {
    /// Sled and friction.
    pub model: PathBuf,
    /// The run's track.
    pub track: Track,
    /// The run's row of its index.
    pub entry: Entry,
    /// Refuse a run with gaps instead of excluding the samples next to them.
    pub strict: bool,
    /// Steps, rate and longest time; the conditions are those of `entry`.
    pub options: SimulateOptions,
}

/// A run that was driven again.
pub struct ReplayedRun {
    /// The vehicle that drove.
    pub vehicle: Vehicle,
    /// The comparison.
    pub replay: Replay,
    /// The model's run as sensors record it, with the measured channels at the same places.
    pub driven: Run,
    /// File of the measured run.
    pub measured: PathBuf,
    /// Tables of the model that do not span every sample.
    pub outside_tables: Vec<OutsideTable>,
}

/// The row of a run in an index, if the run is on this track.
///
/// # Errors
/// [`Failure::BadInput`] with the known runs, or with the track of the run.
pub fn entry_on_track(index: &Path, run: &str, track: &Track) -> Result<Entry, Failure> {
    let within = |failure: Failure| failure.within(index.display());
    let entries = read_index(index)?;
    let entry = named_run(&entries, run, |entry| &entry.run).map_err(within)?;
    if entry.track != track.name {
        return Err(within(Failure::BadInput(format!(
            "run {run} is on track {}: expected a run on {}",
            entry.track, track.name
        ))));
    }
    Ok(entry.clone())
}

/// Replays a run under its own conditions. Returns the comparison, the model's run as its sensors
/// record it, and the driver's inputs.
pub(crate) fn drive_again(
    run: &Run,
    vehicle: &Vehicle,
    track: &Track,
    options: &SimulateOptions,
) -> Result<(Replay, Run, Inputs), kufe_sled::Error> {
    let options = SimulateOptions {
        conditions: run.entry.conditions,
        ..options.clone()
    };
    let inputs = Inputs::of(run, vehicle, track.s_m[0])?;
    let done = replay(&inputs, vehicle, &TrackShape::new(track), &options)?;
    let mut driven = record(&done.simulated, vehicle, None, run.entry.clone(), 0);
    driven.t0_s = inputs.readings[0].t_s;
    Ok((done, driven, inputs))
}

impl ReplayedDrive {
    /// Replays the run.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, and for options out of range.
    pub fn drive(&self, watch: &Watch) -> Result<ReplayedRun, Failure> {
        let (_, vehicle) = load_model(&self.model)?;
        warn_elsewhere(&vehicle, &self.model, &[&self.track.name], watch);
        let run = read_for_replay(&self.entry, on_gaps(self.strict))?;
        for remark in &run.remarks {
            watch.warn(remark);
        }
        watch.check()?;
        let (done, mut driven, inputs) = drive_again(&run, &vehicle, &self.track, &self.options)?;
        add_measured_columns(&mut driven, &inputs);
        let states = done.simulated.instants.iter().map(|instant| &instant.state);
        let outside_tables = outside_tables(&vehicle, states);
        for outside in &outside_tables {
            watch.warn(&format!("{}: {outside}", done.run));
        }
        if !done.taking_part.gaps.is_none() {
            watch.warn(&gaps_line(std::slice::from_ref(&done.taking_part)));
        }
        if done.bridged_m > 0.0 {
            watch.warn(&format!(
                "{}: the steering crosses {:.1} m without a value on a straight line",
                done.run, done.bridged_m
            ));
        }
        if let Some(reason) = &done.stopped {
            watch.warn(&format!("{}: {reason}; compared up to there", done.run));
        }
        Ok(ReplayedRun {
            vehicle,
            replay: done,
            driven,
            measured: run.entry.file,
            outside_tables,
        })
    }
}

impl ReplayedRun {
    /// The document.
    pub fn document(&self) -> ReplayResult<'_> {
        let (measured, outside) = (self.measured.clone(), self.outside_tables.clone());
        ReplayResult::new(&self.replay, measured, outside)
    }
}
