//! Selection and preparation of recorded runs.

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

/// A selection of runs, with the model and the filter that they are prepared with.
#[derive(Clone, Debug)]
pub struct RunSelection {
    /// Index file of the runs.
    pub runs: PathBuf,
    /// Model file of sled and friction.
    pub model: PathBuf,
    /// Sessions to select; empty selects all.
    pub session: Vec<String>,
    /// Tracks to select; empty selects all.
    pub track: Vec<String>,
    /// Exclude runs with faulty files instead of stopping at the first.
    pub leave_out_bad_runs: bool,
    /// Refuse runs with gaps instead of excluding the samples next to them.
    pub strict: bool,
    /// Cutoff frequency of the zero-phase low-pass filter [Hz].
    pub cutoff_hz: f64,
}

/// Prepared runs with their model.
pub struct PreparedRuns {
    /// Sled and friction, as the model file states them.
    pub model: Model,
    /// The model with its tables read.
    pub vehicle: Vehicle,
    /// The runs.
    pub prepared: Vec<Prepared>,
    /// Exclusions, gaps and places outside tables, for the results.
    pub used: RunsUsed,
    /// Standard deviation of the white noise of the slip angle at the sample rate of the
    /// recordings, median over the runs [rad].
    pub slip_noise_rad: f64,
}

/// The files that an index of runs names (runs and track tables), and the index itself.
pub fn run_inputs(index: &Path) -> Vec<PathBuf> {
    let entries = read_index(index).unwrap_or_default();
    let tracks: BTreeSet<String> = entries.iter().map(|run| track_file(&run.track)).collect();
    let tracks = tracks.iter().map(|name| index.with_file_name(name));
    let runs = entries.into_iter().map(|run| run.file);
    let index = [index.to_path_buf()].into_iter();
    index.chain(runs).chain(tracks).collect()
}

/// The format that the option `--parquet` selects.
pub fn run_format(parquet: bool) -> RunFormat {
    if parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    }
}

/// Writes the runs and, last, the index; names each run's file.
///
/// # Errors
/// [`Failure::BadInput`] for a file that cannot be written.
pub fn write_runs(output: &NewFiles, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
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
pub fn write_track(output: &NewFiles, track: &Track) -> Result<(), Failure> {
    output.write(&track_file(&track.name), |file| {
        track.write_csv(BufWriter::new(file))
    })
}

/// Treatment of runs with gaps: refused with `strict`, else the samples next to a gap are excluded.
pub fn on_gaps(strict: bool) -> OnGaps {
    if strict {
        OnGaps::Refuse
    } else {
        OnGaps::LeaveOut
    }
}

/// The run whose name, as `name_of` returns it, is `name`.
///
/// # Errors
/// [`Failure::BadInput`] with the known names.
pub fn named_run<'a, T>(
    runs: &'a [T],
    name: &str,
    name_of: fn(&T) -> &String,
) -> Result<&'a T, Failure> {
    runs.iter().find(|run| name_of(run) == name).ok_or_else(|| {
        let names: Vec<&str> = runs.iter().map(|run| name_of(run).as_str()).collect();
        Failure::BadInput(format!("--run {name}: the runs are {}", names.join(", ")))
    })
}

/// Coverage of the runs that have gaps.
pub(crate) fn gaps_of(prepared: &[Prepared]) -> Vec<SampleCoverage> {
    let coverage = prepared.iter().map(|run| run.taking_part.clone());
    coverage.filter(|run| !run.gaps.is_none()).collect()
}

/// A text field of a run.
type Field = fn(&Run) -> &String;

/// Distinct values of a field, sorted.
fn distinct(runs: &[Run], field: Field) -> Vec<&str> {
    let values: BTreeSet<&str> = runs.iter().map(|run| field(run).as_str()).collect();
    values.into_iter().collect()
}

/// Reads a model file, and the tables of its sled.
pub(crate) fn load_model(path: &Path) -> Result<(Model, Vehicle), Failure> {
    let model = Model::load(path)?;
    let vehicle = Vehicle::with_effects(&model)?;
    Ok((model, vehicle))
}

/// Warns of effects in a model that act on none of these tracks.
pub(crate) fn warn_elsewhere(vehicle: &Vehicle, model: &Path, tracks: &[&str], watch: &Watch) {
    for text in vehicle.effects_elsewhere(tracks) {
        watch.warn(&format!("{}: {text}", model.display()));
    }
}

impl RunSelection {
    /// Every run of an index, with a model file and a cutoff frequency of 20 Hz.
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

    /// Reads the model and the runs, keeps the runs of the selection for which `keep` is true (as
    /// those that a fit did not use), and prepares them. Remarks on runs become warnings.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for an invalid cutoff
    /// frequency.
    pub fn load(
        &self,
        watch: &Watch,
        keep: impl Fn(&Run) -> bool,
    ) -> Result<PreparedRuns, Failure> {
        // Below 0.1 Hz the filter removes the curves themselves: one period is as long as a run.
        if !(0.1..=1e4).contains(&self.cutoff_hz) {
            let expected = "0.1 to 10000 Hz";
            return Err(Failure::option("cutoff-hz", self.cutoff_hz, expected));
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
        let tracks = distinct(&runs, |run| &run.entry.track);
        warn_elsewhere(&vehicle, &self.model, &tracks, watch);
        self.select(&mut runs)?;
        let requested = runs.len();
        runs.retain(keep);
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

    /// Retains the runs of the requested sessions and tracks.
    fn select(&self, runs: &mut Vec<Run>) -> Result<(), Failure> {
        let (session, track): (Field, Field) = (|run| &run.entry.session, |run| &run.entry.track);
        let filters = [
            ("session", &self.session, session),
            ("track", &self.track, track),
        ];
        for (option, names, field) in filters {
            let is_unknown = |name: &&String| runs.iter().all(|run| field(run) != *name);
            if let Some(name) = names.iter().find(is_unknown) {
                let (index, known) = (self.runs.display(), distinct(runs, field).join(", "));
                let text = format!("--{option} {name}: {index} has only {known}");
                return Err(Failure::BadInput(text));
            }
        }
        runs.retain(|run| {
            let mut filters = filters.iter();
            filters.all(|(_, names, field)| names.is_empty() || names.contains(field(run)))
        });
        Ok(())
    }
}
