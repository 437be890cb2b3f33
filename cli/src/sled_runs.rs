//! What the commands on recorded runs share: their arguments, and runs read, chosen and prepared.

use std::path::PathBuf;

use kufe_sled::{Error, Model, PrepareOptions, Prepared, Run, Vehicle, prepare_all};

use crate::failure::Failure;
use crate::output::Global;

/// Arguments that every command on runs takes.
#[derive(clap::Args, Debug)]
pub struct RunArgs {
    /// Index of the runs: run, file, track, driver, driver_class, session, ice_c, air_c, air_pa
    pub runs: PathBuf,
    /// Sled and friction
    #[arg(long, short, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Folder for the results
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Only runs of these sessions (several with commas)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub session: Vec<String>,
    /// Only runs on these tracks (several with commas)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub track: Vec<String>,
    /// Leave runs with faulty files out and say so, instead of stopping at the first
    #[arg(long)]
    pub leave_out_bad_runs: bool,
    /// Corner of the zero-phase low pass [Hz]
    #[arg(long, value_name = "HZ", default_value_t = 20.0)]
    pub cutoff: f64,
}

/// Runs ready for use, and what they are used with.
pub struct Loaded {
    pub model: Model,
    pub vehicle: Vehicle,
    pub prepared: Vec<Prepared>,
    /// Runs left out and why.
    pub left_out: Vec<String>,
}

/// The failure that a sled error is.
pub fn failure(error: &Error) -> Failure {
    match error {
        Error::Friction(kufe_friction::Error::NotConverged { .. }) => {
            Failure::NotConverged(error.to_string())
        }
        _ => Failure::BadInput(error.to_string()),
    }
}

impl RunArgs {
    /// Reads model and runs, keeps those that `wanted` and the options name, and prepares them.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for a corner that is no filter.
    pub fn load(&self, global: &Global, wanted: impl Fn(&Run) -> bool) -> Result<Loaded, Failure> {
        if !(self.cutoff > 0.0 && self.cutoff <= 1e4) {
            return Err(Failure::Usage(format!(
                "--cutoff {}: expected above 0, up to 10000 Hz",
                self.cutoff
            )));
        }
        let model = Model::load(&self.model).map_err(|error| failure(&error))?;
        let vehicle = Vehicle::with_effects(&model).map_err(|error| failure(&error))?;
        let bar = global.progress();
        bar.set_message(format!("reading {}", self.runs.display()));
        let (mut runs, left_out) = if self.leave_out_bad_runs {
            let (runs, bad) =
                kufe_sled::read_good_runs(&self.runs).map_err(|error| failure(&error))?;
            (runs, bad.iter().map(ToString::to_string).collect())
        } else {
            let runs = kufe_sled::read_runs(&self.runs).map_err(|error| failure(&error))?;
            (runs, Vec::new())
        };
        self.known("session", &self.session, &runs, |run| &run.entry.session)?;
        self.known("track", &self.track, &runs, |run| &run.entry.track)?;
        let among = |names: &[String], name: &String| names.is_empty() || names.contains(name);
        runs.retain(|run| {
            among(&self.session, &run.entry.session)
                && among(&self.track, &run.entry.track)
                && wanted(run)
        });
        if runs.is_empty() {
            return Err(Failure::BadInput(format!(
                "{}: no run is left of those asked for",
                self.runs.display()
            )));
        }
        if !global.quiet {
            for text in runs.iter().flat_map(|run| &run.remarks).chain(&left_out) {
                eprintln!("kufe: note: {text}");
            }
        }
        bar.set_message(format!("preparing {} runs", runs.len()));
        let options = PrepareOptions {
            cutoff_hz: self.cutoff,
            ..PrepareOptions::default()
        };
        let prepared = prepare_all(&runs, &vehicle, model.noise.as_ref(), &options)
            .map_err(|error| failure(&error))?;
        bar.finish_and_clear();
        Ok(Loaded {
            model,
            vehicle,
            prepared,
            left_out,
        })
    }

    fn known(
        &self,
        option: &str,
        asked: &[String],
        runs: &[Run],
        of: fn(&Run) -> &String,
    ) -> Result<(), Failure> {
        for name in asked {
            if !runs.iter().any(|run| of(run) == name) {
                let mut there: Vec<&str> = runs.iter().map(|run| of(run).as_str()).collect();
                there.sort_unstable();
                there.dedup();
                return Err(Failure::BadInput(format!(
                    "--{option} {name}: {} has only {}",
                    self.runs.display(),
                    there.join(", ")
                )));
            }
        }
        Ok(())
    }
}

/// A run's name as part of a file's name.
pub fn file_name(run: &str) -> String {
    run.chars()
        .map(|c| {
            if c.is_alphanumeric() || "-._".contains(c) {
                c
            } else {
                '_'
            }
        })
        .collect()
}
