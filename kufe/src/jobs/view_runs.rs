//! Data of the page that shows recorded runs: every channel at one rate, the channels of the
//! replayed run at the same places, and anomalies.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kufe_sled::{
    COLUMNS, Column, Entry, Examination, Fault, Model, Note, OddStretch, PrepareOptions, Prepared,
    Run, Section, SimulateOptions, Track, Vehicle, bridged, examine, find_contacts, integral,
    prepare, read_index, resample_stretches, track_file,
};
use serde::{Serialize, Serializer};

use rayon::prelude::*;

use crate::jobs::failure::Failure;
use crate::jobs::gather::UNNAMED;
use crate::jobs::replay::drive_again;
use crate::jobs::runs::{load_model, named_run, warn_elsewhere};
use crate::jobs::watch::Watch;
use crate::results::pack;

/// Rates at which channels are shown [Hz]: the first with which the page is short enough.
const RATES_HZ: [f64; 7] = [100.0, 50.0, 25.0, 10.0, 5.0, 2.0, 1.0];

/// The runs that are shown, and the size of the page.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    /// Index of the runs.
    pub runs: PathBuf,
    /// Model file of sled and friction; with it the replayed run is shown too.
    pub model: Option<PathBuf>,
    /// Table of the runs' track; where absent, the tables in the folder of the index.
    pub track: Option<PathBuf>,
    /// Names of the runs to show; empty shows all.
    pub only: Vec<String>,
    /// Largest number of values of all runs and channels together.
    pub max_values: usize,
}

/// Recorded runs at one rate.
#[derive(Serialize)]
pub struct ViewedRuns {
    /// Index of the runs.
    pub index: String,
    /// Largest rate of the channels [Hz]; a slower recording keeps its own.
    pub rate_hz: f64,
    /// The model's file.
    pub model: Option<String>,
    /// The runs in the order of the index.
    pub runs: Vec<ViewedRun>,
    /// Runs that cannot be read, each with the reason.
    pub left_out: Vec<[String; 2]>,
}

/// Values of channels by name.
type Columns = BTreeMap<String, Vec<f64>>;

/// One recorded run as the page's script reads it.
#[derive(Serialize)]
pub struct ViewedRun {
    /// Its name.
    pub run: String,
    /// Its track, driver and session, where the index states them.
    pub track: Option<String>,
    /// See `track`.
    pub driver: Option<String>,
    /// See `track`.
    pub session: Option<String>,
    /// Time of the first sample, as recorded [s].
    pub t0_s: f64,
    /// Rate of the channels [Hz].
    pub rate_hz: f64,
    /// Every channel, `s_m` among them; NaN in gaps.
    #[serde(serialize_with = "packed")]
    pub columns: Columns,
    /// Readings of the model's sensors at the same places, and `behind_s`, the time by which the
    /// run is later than the model; NaN where the model did not arrive. Empty without a model.
    #[serde(serialize_with = "packed")]
    pub model: Columns,
    /// Anomalous stretches of its channels.
    pub stretches: Vec<OddStretch>,
    /// Sections in which run and model diverge.
    pub sections: Vec<Section>,
    /// Start and end of the times at which forces other than those of ice and air act, by the
    /// model [s].
    pub contacts: Vec<[f64; 2]>,
    /// Faults of the recording.
    pub faults: Vec<Fault>,
    /// Other anomalies.
    pub notes: Vec<Note>,
}

fn packed<S: Serializer>(columns: &Columns, serializer: S) -> Result<S::Ok, S::Error> {
    let columns = columns.iter();
    serializer.collect_map(columns.map(|(name, values)| (name, pack(values.iter().copied()))))
}

/// The model and the tracks that it drives on.
struct ReplayModel {
    model: Model,
    vehicle: Vehicle,
    tracks: BTreeMap<String, Track>,
}

/// Reads and examines the runs of an index, and brings them to a rate with which all values
/// together are at most `max_values`.
///
/// A run without `s_m` has the integral of its speed, from the start of its track's table where
/// there is a model. A run on a track without a table has no curves of the model.
///
/// # Errors
/// [`Failure::BadInput`] for index, model and tracks that cannot be read, and where no run can be
/// shown or they are too long.
pub fn view_runs(options: &ViewOptions, watch: &Watch) -> Result<ViewedRuns, Failure> {
    let wrong = |reason: String| Failure::in_file(&options.runs, reason);
    let entries = read_index(&options.runs)?;
    for name in &options.only {
        let known = named_run(&entries, name, |entry| &entry.run);
        known.map_err(|failure| failure.within(options.runs.display()))?;
    }
    let model = options.model.as_ref();
    let driven = model.map(|model| ReplayModel::read(model, options, &entries, watch));
    let driven = driven.transpose()?;
    watch.progress(&format!("examining {} runs", entries.len()));
    let is_chosen = |run: &str| options.only.is_empty() || options.only.iter().any(|n| n == run);
    let shown = |(one, run): (Examination, Option<Run>)| {
        let run = run.filter(|_| one.refused.is_none() && is_chosen(&one.run));
        let viewed = run.map(|run| viewed(&run, &one, driven.as_ref(), watch));
        (one, viewed)
    };
    let examined = examine(&options.runs)?.into_par_iter().map(shown);
    let (mut runs, mut left_out) = (BTreeMap::new(), Vec::new());
    let mut prepared = Vec::new();
    for (one, run) in examined.collect::<Vec<_>>() {
        match (one.refused, run) {
            (Some(reason), _) if is_chosen(&one.run) => left_out.push([one.run, reason]),
            (_, Some((run, states))) => {
                prepared.extend(states);
                runs.insert(one.run, run);
            }
            _ => {}
        }
    }
    if let Some(driven) = &driven {
        let marks = find_contacts(&prepared, &driven.vehicle);
        for (run, marks) in prepared.iter().zip(marks) {
            if let Some(viewed) = runs.get_mut(&run.entry.run) {
                viewed.contacts = marked_times(run, &marks);
            }
        }
    }
    let entries = entries.iter();
    let mut runs: Vec<ViewedRun> = entries.filter_map(|e| runs.remove(&e.run)).collect();
    if runs.is_empty() {
        let reason = left_out.first();
        let reason = reason.map_or(String::new(), |[run, why]| format!(": run {run}: {why}"));
        return Err(wrong(format!("no run can be shown{reason}")));
    }
    let fits = |rate: &&f64| count(&runs, **rate) <= options.max_values;
    let Some(&rate_hz) = RATES_HZ.iter().find(fits) else {
        let (count, lengths) = (runs.len(), runs.iter().map(ViewedRun::length_s));
        return Err(wrong(format!(
            "{count} runs of {:.0} s together: too long for one page; expected fewer, by --run",
            lengths.sum::<f64>()
        )));
    };
    for run in runs.iter_mut().filter(|run| run.rate_hz > rate_hz) {
        for values in run.columns.values_mut().chain(run.model.values_mut()) {
            *values = resample_stretches(values, run.rate_hz, rate_hz);
        }
        run.rate_hz = rate_hz;
    }
    Ok(ViewedRuns {
        index: options.runs.display().to_string(),
        rate_hz,
        model: model.map(|path| path.display().to_string()),
        runs,
        left_out,
    })
}

impl ViewedRun {
    fn length_s(&self) -> f64 {
        self.columns[Column::Distance.name()].len() as f64 / self.rate_hz
    }
}

/// Values of all channels at a rate [Hz].
fn count(runs: &[ViewedRun], rate_hz: f64) -> usize {
    let values = |run: &ViewedRun| {
        let samples = run.columns.values().chain(run.model.values()).map(Vec::len);
        samples.sum::<usize>() as f64 * (rate_hz / run.rate_hz).min(1.0)
    };
    runs.iter().map(values).sum::<f64>() as usize
}

impl ReplayModel {
    fn read(
        model: &Path,
        options: &ViewOptions,
        entries: &[Entry],
        watch: &Watch,
    ) -> Result<ReplayModel, Failure> {
        let names: BTreeSet<&str> = entries.iter().map(|entry| entry.track.as_str()).collect();
        let names: Vec<&str> = names.into_iter().collect();
        let file = model;
        let (model, vehicle) = load_model(file)?;
        warn_elsewhere(&vehicle, file, &names, watch);
        let mut tracks = BTreeMap::new();
        if let Some(path) = &options.track {
            let track = Track::load(path)?;
            tracks.insert(track.name.clone(), track);
        }
        for name in names.into_iter().filter(|_| options.track.is_none()) {
            let path = options.runs.with_file_name(track_file(name));
            if path.is_file() {
                tracks.insert(name.to_owned(), Track::load(&path)?);
                continue;
            }
            let path = path.display();
            watch.warn(&format!(
                "{path}: no such table: no model on track {name}; copy the survey there, or estimate it: kufe runs align"
            ));
        }
        Ok(ReplayModel {
            model,
            vehicle,
            tracks,
        })
    }
}

/// A run at the largest rate, and its prepared states if there is a model and all channels are
/// present.
fn viewed(
    run: &Run,
    examination: &Examination,
    driven: Option<&ReplayModel>,
    watch: &Watch,
) -> (ViewedRun, Option<Prepared>) {
    let rate_hz = RATES_HZ[0].min(run.rate_hz());
    let resampled = |values: &[f64]| resample_stretches(values, run.rate_hz(), rate_hz);
    let has_values = |values: &&Vec<f64>| values.iter().any(|x| x.is_finite());
    let columns = run.columns.iter().filter(|(_, values)| has_values(values));
    let columns = columns.map(|(name, values)| (name.clone(), resampled(values)));
    let mut columns: Columns = columns.collect();
    let track = driven.and_then(|driven| driven.tracks.get(&run.entry.track));
    if !columns.contains_key(Column::Distance.name()) {
        // The integral of the speed by the trapezoidal rule.
        let speed = run.columns.get(Column::Speed.name()).map(|v| bridged(v));
        let start_m = track.map_or(0.0, |track| track.s_m[0]);
        let distance = integral(&speed.unwrap_or_default(), run.dt_s).into_iter();
        let distance: Vec<f64> = distance.map(|s_m| start_m + s_m).collect();
        columns.insert(Column::Distance.name().to_owned(), resampled(&distance));
    }
    let (mut model, mut sections, mut prepared) = (BTreeMap::new(), Vec::new(), None);
    if let Some((driven, track)) = driven.zip(track) {
        match drive_again(run, &driven.vehicle, track, &SimulateOptions::default()) {
            Ok((done, replayed, _)) => {
                let places = &columns[Column::Distance.name()];
                model = model_at(places, run.t0_s, rate_hz, &replayed);
                model.retain(|name, _| name == BEHIND || columns.contains_key(name));
                sections = done.sections;
            }
            Err(error) => watch.warn(&format!("{error}: no model of run {}", run.entry.run)),
        }
        let noise = driven.model.noise.as_ref();
        prepared = prepare(run, &driven.vehicle, noise, &PrepareOptions::default()).ok();
    }
    let stated = |name: &String| (name != UNNAMED).then(|| name.clone());
    let viewed = ViewedRun {
        run: run.entry.run.clone(),
        track: stated(&run.entry.track),
        driver: stated(&run.entry.driver),
        session: stated(&run.entry.session),
        t0_s: run.t0_s,
        rate_hz,
        columns,
        model,
        stretches: examination.stretches.clone(),
        sections,
        contacts: Vec::new(),
        faults: examination.faults.clone(),
        notes: examination.notes.clone(),
    };
    (viewed, prepared)
}

/// Name of the column of the time by which a run is later than the model.
pub const BEHIND: &str = "behind_s";

/// The channels of a replayed run at the places of the measured run, whose samples start at `t0_s`
/// [s] with a rate [Hz]. The steering is omitted: it is that of the measured run.
fn model_at(places: &[f64], t0_s: f64, rate_hz: f64, replayed: &Run) -> Columns {
    let passed = &replayed.columns[Column::Distance.name()];
    let mut at = 0;
    // The sample before each place, and the fraction of the way to the next sample.
    let passages = places.iter().map(|place| {
        while at + 2 < passed.len() && passed[at + 1] <= *place {
            at += 1;
        }
        let around = passed[at..].first_chunk::<2>();
        let around = around.filter(|[a, b]| a < b && (*a..=*b).contains(place));
        around.map(|[a, b]| (at, (place - a) / (b - a)))
    });
    let passages: Vec<Option<(usize, f64)>> = passages.collect();
    let at_places = |value: &dyn Fn(usize, (usize, f64)) -> f64| -> Vec<f64> {
        let passages = passages.iter().enumerate();
        let values = passages.map(|(k, passage)| passage.map_or(f64::NAN, |at| value(k, at)));
        values.collect()
    };
    let names = COLUMNS.iter();
    let names = names.filter(|name| **name != Column::Steering.name());
    let channels = names.map(|name| {
        let from = &replayed.columns[*name];
        let value = |_, (at, share)| from[at] + share * (from[at + 1] - from[at]);
        ((*name).to_owned(), at_places(&value))
    });
    let late = |k: usize, (at, share): (usize, f64)| {
        let measured_s = t0_s + k as f64 / rate_hz;
        measured_s - replayed.t0_s - (at as f64 + share) * replayed.dt_s
    };
    channels
        .chain([(BEHIND.to_owned(), at_places(&late))])
        .collect()
}

/// The times of the first and last of each stretch of marked states [s].
fn marked_times(run: &Prepared, marks: &[bool]) -> Vec<[f64; 2]> {
    let mut times: Vec<[f64; 2]> = Vec::new();
    let mut last = None;
    for (i, state) in run.states.iter().enumerate().filter(|(i, _)| marks[*i]) {
        match times.last_mut().filter(|_| last == Some(i.wrapping_sub(1))) {
            Some(stretch) => stretch[1] = state.t_s,
            None => times.push([state.t_s, state.t_s]),
        }
        last = Some(i);
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_the_first_that_the_page_has_room_for_and_distance_is_the_speeds_integral() {
        let folder = tempfile::tempdir().expect("a folder");
        let index = folder.path().join("runs.csv");
        std::fs::write(&index, "run,file\na,a.csv\n").expect("a file");
        let rows = (0..=1200).map(|i| {
            let t = 0.01 * f64::from(i);
            format!("{t:.2},{:.6}\n", 10.0 + 2.0 * t)
        });
        let text = "t_s,v_mps\n".to_owned() + &rows.collect::<String>();
        std::fs::write(folder.path().join("a.csv"), text).expect("a file");
        let with = |max_values| {
            let options = ViewOptions {
                runs: index.clone(),
                model: None,
                track: None,
                only: Vec::new(),
                max_values,
            };
            view_runs(&options, &Watch::default())
        };
        // Speed and distance, 1201 values each at 100 Hz.
        for (most, rate_hz, samples) in [(2402, 100.0, 1201), (2401, 50.0, 601), (150, 5.0, 61)] {
            let viewed = with(most).expect("runs");
            assert_eq!(viewed.rate_hz, rate_hz);
            let run = &viewed.runs[0];
            let distance = &run.columns["s_m"];
            assert_eq!((run.rate_hz, distance.len()), (rate_hz, samples));
            // 10 t + t^2, of a speed that is even: the trapezoidal rule is exact.
            // The low pass changes the ends: a second, or several of its periods.
            let ends = (rate_hz as usize).max(15);
            let inner = distance.iter().enumerate().skip(ends);
            for (k, s) in inner.take(samples - 2 * ends) {
                let t = k as f64 / rate_hz;
                assert!((s - t * (10.0 + t)).abs() < 2e-3, "{most}: {s} m at {t} s");
            }
        }
        let refused = with(20).err().expect("too long").to_string();
        assert!(refused.contains("too long for one page"), "{refused}");
    }
}
