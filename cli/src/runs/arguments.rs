//! Arguments of the commands on recorded runs, and the runs that they select.

use std::path::PathBuf;

use kufe::jobs::runs::{RunSelection, run_inputs};

/// Arguments that every command on runs takes.
#[derive(clap::Args, Debug)]
pub struct RunArgs {
    /// Index of the runs: run, file, and where known track, driver, driver_class, session, ice_c,
    /// air_c, air_pa
    pub runs: PathBuf,
    /// Model of the sled and its friction
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
    /// Exclude runs with faulty files, with a warning, instead of stopping at the first
    #[arg(long)]
    pub leave_out_bad_runs: bool,
    /// Refuse runs with missing files, values or rows, uneven times or standstill, instead of
    /// excluding them
    #[arg(long)]
    pub strict: bool,
    /// Frequency above which channels are smoothed, without delay [Hz]
    #[arg(long, value_name = "HZ", default_value_t = 20.0)]
    pub cutoff_hz: f64,
}

impl RunArgs {
    /// The files that are read: the model, the index and what it names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = run_inputs(&self.runs);
        inputs.push(self.model.clone());
        inputs
    }

    /// The runs that the options select, and what they are used with.
    pub fn selection(&self) -> RunSelection {
        RunSelection {
            runs: self.runs.clone(),
            model: self.model.clone(),
            session: self.session.clone(),
            track: self.track.clone(),
            leave_out_bad_runs: self.leave_out_bad_runs,
            strict: self.strict,
            cutoff_hz: self.cutoff_hz,
        }
    }
}
