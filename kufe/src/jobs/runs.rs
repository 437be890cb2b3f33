//! Recorded runs: read, chosen and prepared.

use std::collections::BTreeSet;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use kufe_sled::{
    Model, Needs, OnGaps, PrepareOptions, Prepared, Run, RunFormat, SampleCoverage, Track, Vehicle,
    estimate_noise, gaps_line, median, outside_tables, prepare_all, read_good_runs, read_index,
    read_runs, run_file, track_file, write_index, write_run,
};
use rayon::prelude::*;

use crate::jobs::failure::Failure;
use crate::jobs::field::NewFiles;
use crate::jobs::watch::Watch;
use crate::results::RunsUsed;

/// Which runs, and what they are used with.
#[derive(Clone, Debug)]
pub struct RunSelection {
    /// Index of the runs.
    pub runs: PathBuf,
    /// Sled and friction.
    pub model: PathBuf,
    /// Only runs of these sessions; all where empty.
    pub session: Vec<String>,
    /// Only runs on these tracks; all where empty.
    pub track: Vec<String>,
    /// Exclude runs with faulty files instead of stopping at the first.
    pub leave_out_bad_runs: bool,
    /// Refuse runs with gaps instead of excluding the samples next to them.
    pub strict: bool,
    /// Corner of the zero-phase low pass [Hz].
    pub cutoff_hz: f64,
}

/// Runs ready for use, and what they are used with.
pub struct PreparedRuns {
    /// Sled and friction.
    pub model: Model,
    /// The same with its tables opened.
    pub vehicle: Vehicle,
    /// The runs.
    pub prepared: Vec<Prepared>,
    /// What results state of the runs.
    pub used: RunsUsed,
    /// White noise of the slip angle at the recordings' own rate, the median of the runs [rad].
    pub slip_noise_rad: f64,
}

/// The files that an index of runs names, itself among them: runs and tables of tracks.
pub fn run_inputs(index: &Path) -> Vec<PathBuf> {
    let entries = read_index(index).unwrap_or_default();
    let tracks: BTreeSet<String> = entries.iter().map(|run| track_file(&run.track)).collect();
    let tracks = tracks.iter().map(|name| index.with_file_name(name));
    let runs = entries.into_iter().map(|run| run.file);
    let index = [index.to_path_buf()].into_iter();
    index.chain(runs).chain(tracks).collect()
}

/// Writes the runs and, last, the index; names each run's file.
///
/// # Errors
/// [`Failure::BadInput`] for a file that cannot be written.
pub fn write_runs(output: NewFiles, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    runs.par_iter_mut().try_for_each(|run| {
        let name = run_file(&run.entry.run, format);
        run.entry.file = PathBuf::from(&name);
        output.write(&name, |mut file| write_run(run, &mut file, format))
    })?;
    let entries: Vec<_> = runs.iter().map(|run| run.entry.clone()).collect();
    output.write("runs.csv", |file| write_index(file, &entries))
}

/// Writes the table of a track.
///
/// # Errors
/// As [`write_runs`].
pub fn write_track(output: NewFiles, track: &Track) -> Result<(), Failure> {
    output.write(&track_file(&track.name), |file| {
        track.write_csv(BufWriter::new(file))
    })
}

/// How runs with gaps are read: refused with `strict`, else without the samples next to a gap.
pub fn on_gaps(strict: bool) -> OnGaps {
    if strict {
        OnGaps::Refuse
    } else {
        OnGaps::LeaveOut
    }
}

/// The run of this name.
///
/// # Errors
/// [`Failure::BadInput`] with the names that there are.
pub fn named_run<'a, T>(
    runs: &'a [T],
    name: &str,
    of: fn(&T) -> &String,
) -> Result<&'a T, Failure> {
    runs.iter().find(|run| of(run) == name).ok_or_else(|| {
        let names: Vec<&str> = runs.iter().map(|run| of(run).as_str()).collect();
        Failure::BadInput(format!("--run {name}: the runs are {}", names.join(", ")))
    })
}

/// Runs with gaps, and how much of them takes part.
pub(crate) fn gaps_of(prepared: &[Prepared]) -> Vec<SampleCoverage> {
    let coverage = prepared.iter().map(|run| run.taking_part.clone());
    coverage.filter(|run| !run.gaps.is_none()).collect()
}

/// Words that runs have, each once, in order.
fn words(runs: &[Run], of: fn(&Run) -> &String) -> Vec<&str> {
    let words: BTreeSet<&str> = runs.iter().map(|run| of(run).as_str()).collect();
    words.into_iter().collect()
}

/// A model file, and its sled with the tables opened.
pub(crate) fn load_model(path: &Path) -> Result<(Model, Vehicle), Failure> {
    let model = Model::load(path)?;
    let vehicle = Vehicle::with_effects(&model)?;
    Ok((model, vehicle))
}

/// Warns of effects of a model that act on none of these tracks.
pub(crate) fn warn_elsewhere(vehicle: &Vehicle, model: &Path, tracks: &[&str], watch: &Watch) {
    for text in vehicle.effects_elsewhere(tracks) {
        watch.warn(&format!("{}: {text}", model.display()));
    }
}

impl RunSelection {
    /// Every run of an index, with the model's file and a corner of 20 Hz.
    pub fn all(runs: PathBuf, model: PathBuf) -> RunSelection {
        RunSelection {
            runs,
            model,
            session: Vec::new(),
            track: Vec::new(),
            leave_out_bad_runs: false,
            strict: false,
            cutoff_hz: 20.0,
        }
    }

    /// Reads model and runs, selects those that the fit of the laws has not seen, as `unseen`
    /// states, and prepares them. Remarks on runs become warnings.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for a corner that is no
    /// filter.
    pub fn load(
        &self,
        watch: &Watch,
        unseen: impl Fn(&Run) -> bool,
    ) -> Result<PreparedRuns, Failure> {
        // A corner below a tenth of a hertz removes every curve, and a run of some ten seconds has
        // no period of it.
        if !(0.1..=1e4).contains(&self.cutoff_hz) {
            return Err(Failure::Usage(format!(
                "--cutoff-hz {}: expected 0.1 to 10000 Hz",
                self.cutoff_hz
            )));
        }
        let (model, vehicle) = load_model(&self.model)?;
        watch.progress(&format!("reading {}", self.runs.display()));
        let on_gaps = on_gaps(self.strict);
        let (mut runs, left_out) = if self.leave_out_bad_runs {
            let (runs, bad) = read_good_runs(&self.runs, &Needs::FORCES, on_gaps)?;
            (runs, bad.iter().map(ToString::to_string).collect())
        } else {
            (read_runs(&self.runs, &Needs::FORCES, on_gaps)?, Vec::new())
        };
        type Word = fn(&Run) -> &String;
        let (session, track): (Word, Word) = (|run| &run.entry.session, |run| &run.entry.track);
        warn_elsewhere(&vehicle, &self.model, &words(&runs, track), watch);
        let chosen = [
            ("session", &self.session, session),
            ("track", &self.track, track),
        ];
        for (option, names, of) in chosen {
            let is_unknown = |name: &&String| runs.iter().all(|run| of(run) != *name);
            if let Some(name) = names.iter().find(is_unknown) {
                let (index, known) = (self.runs.display(), words(&runs, of).join(", "));
                let text = format!("--{option} {name}: {index} has only {known}");
                return Err(Failure::BadInput(text));
            }
        }
        runs.retain(|run| {
            let mut chosen = chosen.iter();
            chosen.all(|(_, names, of)| names.is_empty() || names.contains(of(run)))
        });
        let requested = runs.len();
        runs.retain(unseen);
        if runs.is_empty() {
            let why = match requested {
                0 => "none is of that session and track".to_owned(),
                all => format!(
                    "the laws were fitted to all {all}; leave some out of the fit, for example with --session"
                ),
            };
            let text = format_args!("no run remains of those requested: {why}");
            return Err(Failure::in_file(&self.runs, text));
        }
        for text in runs.iter().flat_map(Run::noticed).chain(left_out.clone()) {
            watch.warn(&text);
        }
        watch.progress(&format!("preparing {} runs", runs.len()));
        let options = PrepareOptions {
            cutoff_hz: self.cutoff_hz,
            ..PrepareOptions::default()
        };
        let prepared = prepare_all(&runs, &vehicle, model.noise.as_ref(), &options)?;
        let gaps = gaps_of(&prepared);
        if !gaps.is_empty() {
            watch.warn(&gaps_line(&gaps));
        }
        let states = prepared.iter().flat_map(|run| &run.states);
        let outside_tables = outside_tables(&vehicle, states);
        for outside in &outside_tables {
            watch.warn(&outside.to_string());
        }
        let slip_noise = runs.iter().map(|run| estimate_noise(run).slip_rad);
        let slip_noise_rad = median(slip_noise).unwrap_or(0.0);
        Ok(PreparedRuns {
            model,
            vehicle,
            prepared,
            used: RunsUsed {
                left_out,
                outside_tables,
                gaps,
                version: env!("CARGO_PKG_VERSION").to_owned(),
            },
            slip_noise_rad,
        })
    }
}
