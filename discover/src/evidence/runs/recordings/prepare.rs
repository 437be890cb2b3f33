//! Signal processing of runs: smoothing, decimation, derivatives and conditions.

use std::collections::{BTreeMap, BTreeSet};

use kufe_sled::effects::Column;
use kufe_sled::{Entry, Model, Noise, Run, SampleCoverage, Track, covariates, gaps_line};
use rayon::prelude::*;

use crate::error::Error;
use crate::evidence::runs::recordings::available::available;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::noise::sensors::{
    NoiseFrom, SensorNoise, estimate, estimate_below, is_contradicted, larger_noise, smaller_noise,
};
use crate::evidence::runs::recordings::smooth_run::{MIN_ROWS, frame, signal_kernel};
use crate::evidence::runs::recordings::survey::{Surveys, count_slopes_downhill};
use crate::evidence::runs::recordings::training_samples::TrainingSamples;
use crate::procedure::lock::{LockRules, Place, Split};
use crate::procedure::rules::Rules;

/// All runs, prepared.
#[derive(Clone, Debug)]
pub struct Data {
    /// The runs, or the segments of a single one.
    pub frames: Vec<Frame>,
    /// Noise of each sensor at the recorded rate.
    pub noise: SensorNoise,
    /// Source of the noise.
    pub noise_from: NoiseFrom,
    /// Columns that were recorded and vary.
    pub available: Vec<Column>,
    /// Whether one run was cut into segments.
    pub segmented: bool,
    /// The tracks that runs can be simulated on, as in their tables.
    pub tracks: Vec<Track>,
    /// Whether these tables count the slope positive uphill.
    pub uphill: bool,
    /// Training and held-out frames.
    pub(crate) locked: Split,
    /// The runs as recorded, for replays; empty for segments of one run.
    pub(crate) runs: Vec<Run>,
    /// Runs with gaps, and how much of them is used.
    pub gaps: Vec<SampleCoverage>,
    /// Remarks: constant columns, segments, remarks of the reader.
    pub remarks: Vec<String>,
}

impl Data {
    /// The tracks with slopes that are positive downhill.
    pub(crate) fn downhill_tracks(&self) -> Vec<Track> {
        let mut tracks = self.tracks.clone();
        if self.uphill {
            for slope in tracks.iter_mut().flat_map(|track| &mut track.slope_rad) {
                *slope = -*slope;
            }
        }
        tracks
    }

    /// The training frames.
    pub(crate) fn training(&self) -> impl Iterator<Item = &Frame> {
        self.locked.training.iter().map(|i| &self.frames[*i])
    }
}

/// Smooths and decimates runs and completes their conditions.
///
/// A part is held out by `lock` before noise, signs and availability are examined: these come from
/// the rest.
///
/// # Errors
/// [`Error::TooFew`] if a run is shorter than the smoothing needs.
pub fn prepare(
    runs: &[Run],
    model: &Model,
    surveys: &Surveys,
    rules: &Rules,
) -> Result<Data, Error> {
    if runs.is_empty() {
        return Err(Error::TooFew {
            what: "runs".to_owned(),
            found: 0,
            needed: 1,
        });
    }
    let mut remarks = remarks_on_runs(runs, model);
    let recordings = &rules.runs.recordings;
    let segmented = runs.len() == 1;
    let entries: Vec<&Entry> = runs.iter().map(|run| &run.entry).collect();
    let stated_of_all = covariates(&entries);
    let smoothed = |run: &Run| {
        let kernel = signal_kernel(run.dt_s, recordings);
        frame(run, &kernel, surveys, recordings)
    };
    let mut frames: Vec<Frame> = runs.par_iter().map(smoothed).collect::<Result<_, _>>()?;
    for ((run, frame), stated_of_run) in runs.iter().zip(&mut frames).zip(&stated_of_all) {
        let stated = model.conditions.unwrap_or_default();
        let stated = stated.complete(&run.entry.conditions);
        frame.humidity_pct = stated.humidity_pct;
        frame.distance_before = stated.distance_m;
        for (name, value) in stated_of_run {
            frame.extra.insert(name.clone(), vec![*value; frame.len()]);
        }
    }
    let with_gaps = runs
        .iter()
        .zip(&frames)
        .filter(|(run, _)| !run.gaps.is_none());
    let gaps: Vec<_> = with_gaps.map(|(run, frame)| coverage(run, frame)).collect();
    if segmented {
        frames = cut(&frames[0]);
        let Some(first) = frames.first() else {
            let run = &runs[0].entry.run;
            return Err(Error::TooFew {
                what: format!("run {run}: segments with enough samples between gaps"),
                found: 0,
                needed: 2,
            });
        };
        remarks.push(format!(
            "one run only: it is cut into {} segments of {:.0} s that serve as runs; differences between runs cannot be detected",
            frames.len(),
            first.t.last().unwrap_or(&0.0) - first.t[0]
        ));
    }
    let names: BTreeSet<&String> = stated_of_all.iter().flat_map(BTreeMap::keys).collect();
    for name in names {
        let without = stated_of_all.iter().filter(|s| !s.contains_key(name));
        if let count @ 1.. = without.count() {
            remarks.push(format!(
                "column {name} is not stated for {count} of {} runs: it is not tested",
                runs.len()
            ));
        }
    }
    if !gaps.is_empty() {
        remarks.push(gaps_line(&gaps));
    }
    let locked = split(&frames, segmented, &rules.lock);
    let samples = training_samples(runs, &frames, segmented, &locked);
    let (noise, noise_from) = sensor_noise(&samples, model, rules, &mut remarks);
    let uphill = count_slopes_downhill(&mut frames, &locked.training, &mut remarks);
    let training: Vec<&Frame> = locked.training.iter().map(|i| &frames[*i]).collect();
    let mut available = available(runs, &samples, &training, &mut remarks);
    if frames.iter().all(|f| f.slope.len() == f.len()) {
        available.push(Column::Slope);
    }
    // Such tables are usually functions of the ice temperature.
    let friction = &model.friction.longitudinal;
    let tables = friction.front_table.is_some() && friction.rear_table.is_some();
    let has_ice = |frame: &Frame| !frame.unstated_conditions().contains(&"ice_c");
    if friction.mu.is_some() && tables && frames.iter().all(has_ice) {
        available.push(Column::Film);
    }
    Ok(Data {
        frames,
        noise,
        noise_from,
        available,
        segmented,
        tracks: Vec::new(),
        uphill,
        runs: if segmented { Vec::new() } else { runs.to_vec() },
        locked,
        gaps,
        remarks,
    })
}

/// Remarks of the reader, and on effects of tracks without runs.
fn remarks_on_runs(runs: &[Run], model: &Model) -> Vec<String> {
    let mut remarks = Vec::new();
    for run in runs {
        let noticed = run.noticed().into_iter();
        remarks.extend(noticed.map(|r| format!("run {}: {r}", run.entry.run)));
    }
    for (name, table) in &model.effects {
        let track = table.get("track").and_then(|track| track.as_str());
        if let Some(track) = track.filter(|track| runs.iter().all(|r| r.entry.track != *track)) {
            remarks.push(format!(
                "[effects.{name}] track = {track:?}: no run is on it, the effect does nothing"
            ));
        }
    }
    remarks
}

/// The sensors' noise and its source: as stated if the recordings agree, else from spectra, else
/// white noise from differences.
fn sensor_noise(
    samples: &[TrainingSamples],
    model: &Model,
    rules: &Rules,
    remarks: &mut Vec<String>,
) -> (SensorNoise, NoiseFrom) {
    let recordings = &rules.runs.recordings;
    let seen = estimate(samples);
    let white = |stated: &Noise, remarks: &mut Vec<String>| {
        let below = estimate_below(samples, recordings.signal_cutoff_hz);
        SensorNoise::white(smaller_noise(stated, &larger_noise(&seen, &below), remarks))
    };
    if let Some(stated) = &model.noise
        && !is_contradicted(stated, &seen, recordings.noise_as_stated)
    {
        return (white(stated, remarks), NoiseFrom::Model);
    }
    let from_hz = recordings.row_cutoff_hz;
    let of_spectra = SensorNoise::of_spectra(samples, from_hz, recordings.quietest_axis);
    match (of_spectra, &model.noise) {
        (Some(noise), stated) => {
            remarks.push(noise.remark(stated.is_some()));
            (noise, NoiseFrom::Spectra)
        }
        (None, Some(stated)) => (white(stated, remarks), NoiseFrom::Doubted),
        (None, None) => (SensorNoise::white(seen), NoiseFrom::Differences),
    }
}

/// Used part of a run with gaps.
fn coverage(run: &Run, frame: &Frame) -> SampleCoverage {
    let begins = |i: &usize| *i == 0 || !frame.is_used[i - 1];
    SampleCoverage {
        run: run.entry.run.clone(),
        gaps: run.gaps.clone(),
        stretches: frame.samples().filter(begins).count(),
        used_s: frame.samples().count() as f64 * frame.sample_s(),
        of_s: run.len() as f64 * run.dt_s,
    }
}

/// Splits the runs, or the segments of one run, into training and held-out ones.
fn split(frames: &[Frame], segmented: bool, lock: &LockRules) -> Split {
    if segmented {
        return lock.segments(frames.len());
    }
    let places: Vec<Place> = frames
        .iter()
        .map(|f| Place {
            session: &f.session,
            track: &f.track,
            driver: &f.driver,
        })
        .collect();
    lock.runs(&places)
}

/// The recorded training samples.
fn training_samples<'a>(
    runs: &'a [Run],
    frames: &[Frame],
    segmented: bool,
    locked: &Split,
) -> Vec<TrainingSamples<'a>> {
    let piece = |i: &usize| {
        if !segmented {
            let run = &runs[*i];
            return TrainingSamples {
                run,
                rows: 0..run.len(),
            };
        }
        let (run, t) = (&runs[0], &frames[*i].t);
        let at = |t: Option<&f64>| (t.unwrap_or(&0.0) / run.dt_s).round() as usize;
        TrainingSamples {
            run,
            rows: at(t.first())..(at(t.last()) + 1).min(run.len()),
        }
    };
    locked.training.iter().map(piece).collect()
}

/// Cuts one long run into about 24 segments of at least 10 s, with 1 s omitted between neighbours;
/// segments that are mostly gaps are omitted.
fn cut(frame: &Frame) -> Vec<Frame> {
    let n = frame.len();
    let gap = ((n as f64 / (frame.t[n - 1] - frame.t[0]).max(1e-9)).round() as usize).max(1);
    let length = (n / 24).max(10 * gap).min(n);
    let count = (n / length).max(1);
    let enough = |piece: &Frame| piece.row_count() >= MIN_ROWS;
    let segment = |k: usize| {
        let to = if count == 1 {
            n
        } else {
            (k + 1) * length - gap
        };
        let mut piece = frame.piece(k * length, to);
        let (from_s, to_s) = (frame.t[k * length], frame.t[to - 1]);
        piece.name = format!("{} {from_s:.0}-{to_s:.0} s", frame.name);
        piece
    };
    (0..count).map(segment).filter(enough).collect()
}
