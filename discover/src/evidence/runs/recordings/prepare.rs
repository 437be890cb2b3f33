//! Signal processing of runs: smoothing, decimation, derivatives and conditions.

use std::collections::{BTreeMap, BTreeSet};

use kufe_sled::effects::Column;
use kufe_sled::{Entry, Model, Noise, Run, SampleCoverage, Track, covariates, gaps_line};
use rayon::prelude::*;

use crate::error::Error;
use crate::evidence::runs::recordings::available::available;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::noise::sensors::{
    NoiseFrom, SensorNoise, doubted, estimate, estimate_below, louder, quieter,
};
use crate::evidence::runs::recordings::smooth_run::{MIN_ROWS, frame, signal_kernel};
use crate::evidence::runs::recordings::survey::{Surveys, turn_slopes};
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
            for track in &mut tracks {
                track
                    .slope_rad
                    .iter_mut()
                    .for_each(|slope| *slope = -*slope);
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
    let mut remarks: Vec<String> = runs
        .iter()
        .flat_map(|run| {
            run.noticed()
                .into_iter()
                .map(move |r| format!("run {}: {r}", run.entry.run))
        })
        .collect();
    for (name, table) in &model.effects {
        let track = table.get("track").and_then(|track| track.as_str());
        if let Some(track) = track.filter(|track| runs.iter().all(|r| r.entry.track != *track)) {
            remarks.push(format!(
                "[effects.{name}] track = {track:?}: no run is on it, the effect does nothing"
            ));
        }
    }
    let recordings = &rules.runs.recordings;
    let segmented = runs.len() == 1;
    let (mut frames, mut gaps) = (Vec::new(), Vec::new());
    let entries: Vec<&Entry> = runs.iter().map(|run| &run.entry).collect();
    let stated_of_all = covariates(&entries);
    let smoothed = |run: &Run| {
        let kernel = signal_kernel(run.dt_s, recordings);
        frame(run, &kernel, surveys, recordings)
    };
    let smoothed: Vec<Frame> = runs.par_iter().map(smoothed).collect::<Result<_, _>>()?;
    for ((run, mut frame), stated_of_run) in runs.iter().zip(smoothed).zip(&stated_of_all) {
        let stated = model.conditions.unwrap_or_default();
        let stated = stated.complete(&run.entry.conditions);
        frame.humidity_pct = stated.humidity_pct;
        frame.distance_before = stated.distance_m;
        for (name, value) in stated_of_run {
            frame.extra.insert(name.clone(), vec![*value; frame.len()]);
        }
        if !run.gaps.is_none() {
            gaps.push(coverage(run, &frame));
        }
        if segmented {
            frames = cut(&frame);
            if frames.is_empty() {
                return Err(Error::TooFew {
                    what: format!(
                        "run {}: segments with enough samples between gaps",
                        run.entry.run
                    ),
                    found: 0,
                    needed: 2,
                });
            }
            remarks.push(format!(
                "one run only: it is cut into {} segments of {:.0} s that serve as runs; differences between runs cannot be detected",
                frames.len(),
                frames[0].t.last().unwrap_or(&0.0) - frames[0].t[0]
            ));
        } else {
            frames.push(frame);
        }
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
    let learned = training_samples(runs, &frames, segmented, &locked);
    let seen = estimate(&learned);
    let as_stated = |stated: &Noise| !doubted(stated, &seen, recordings.noise_as_stated);
    let white = |stated: &Noise, remarks: &mut Vec<String>| {
        let below = estimate_below(&learned, recordings.signal_cutoff_hz);
        SensorNoise::white(quieter(stated, &louder(&seen, &below), remarks))
    };
    let of_spectra = || {
        let from_hz = recordings.row_cutoff_hz;
        SensorNoise::of_spectra(&learned, from_hz, recordings.quietest_axis)
    };
    let (noise, noise_from) = match &model.noise {
        Some(stated) if as_stated(stated) => (white(stated, &mut remarks), NoiseFrom::Model),
        stated => match (of_spectra(), stated) {
            (Some(noise), _) => {
                remarks.push(noise.remark(stated.is_some()));
                (noise, NoiseFrom::Spectra)
            }
            (None, Some(stated)) => (white(stated, &mut remarks), NoiseFrom::Doubted),
            (None, None) => (SensorNoise::white(seen), NoiseFrom::Differences),
        },
    };
    let uphill = turn_slopes(&mut frames, &locked.training, &mut remarks);
    let training: Vec<&Frame> = locked.training.iter().map(|i| &frames[*i]).collect();
    let mut available = available(runs, &learned, &training, &mut remarks);
    if frames.iter().all(|f| f.slope.len() == f.len()) {
        available.push(Column::Slope);
    }
    // Such tables are usually functions of the ice temperature.
    let friction = &model.friction.longitudinal;
    let tables = friction.front_table.is_some() && friction.rear_table.is_some();
    if friction.mu.is_some()
        && tables
        && frames
            .iter()
            .all(|f| !f.unstated_conditions().contains(&"ice_c"))
    {
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
    (0..count)
        .map(|k| {
            let (from, to) = (
                k * length,
                if count == 1 {
                    n
                } else {
                    (k + 1) * length - gap
                },
            );
            let mut piece = frame.piece(from, to);
            piece.name = format!(
                "{} {:.0}-{:.0} s",
                frame.name,
                frame.t[from],
                frame.t[to - 1]
            );
            piece
        })
        .filter(enough)
        .collect()
}
