//! Commands on runs: simulation, fits, comparison with a model, and the search for missing effects.

pub mod discover;
pub mod evaluate;
pub mod fit;
pub mod simulate;
pub mod validate;

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use kufe::charts::table_picture;
use kufe::jobs::runs::{RunSelection, run_inputs};
use kufe::jobs::view_runs::{ViewOptions, ViewedRuns, view_runs};
use kufe::jobs::{Failure, Located, table::read_table, write_document_mat};
use kufe::report::{Kind, RunsPage, TABLE_PICTURES, VIEWER, page};
use kufe_lut::{MatValue, Point};
use kufe_sled::Vehicle;
use serde::Serialize;

use crate::output::OutputDir;
use crate::terminal::{Global, warn};

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
    /// Cutoff frequency of the zero-phase low-pass filter of the channels [Hz]
    #[arg(long, value_name = "HZ", default_value_t = 20.0)]
    pub cutoff_hz: f64,
}

impl RunArgs {
    /// The input files: the model, the index, and the files that the index names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = run_inputs(&self.runs);
        inputs.push(self.model.clone());
        inputs
    }

    /// The selection of runs by the options, with model and filter.
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

/// Writes every key of `document`, and `series`, for MATLAB.
pub fn write_mat(
    output: &OutputDir,
    name: &str,
    document: &impl Serialize,
    series: (String, MatValue),
) -> Result<(), Failure> {
    output.write(name, |file| {
        let mut writer = BufWriter::new(file);
        write_document_mat(&mut writer, document, vec![series])?;
        writer.flush().bad_input()
    })
}

/// Draws the tables of the model with the samples of the runs.
///
/// # Errors
/// [`Failure::BadInput`] for a table that cannot be read, or a picture that cannot be written.
pub fn draw_tables(
    output: &OutputDir,
    vehicle: &Vehicle,
    samples: &[Vec<Point>; 2],
) -> Result<(), Failure> {
    let runners = TABLE_PICTURES.iter().zip(["front", "rear"]);
    for (((name, runner), table), requested) in runners.zip(vehicle.tables()).zip(samples) {
        let Some(file) = table.map(|table| PathBuf::from(&table.file)) else {
            continue;
        };
        let table = read_table(&file)?;
        let picture = table_picture(&table, table.judged(), Point::default(), requested);
        let mut figure = picture.in_file(&file)?.figure;
        figure.title = format!("{runner} runner: {}", figure.title);
        output.picture(name, &figure)?;
    }
    Ok(())
}

/// Options that show all runs of an index without a model, with the default size of the page.
pub fn all_runs(runs: PathBuf) -> ViewOptions {
    ViewOptions {
        runs,
        model: None,
        track: None,
        only: Vec::new(),
        max_values: RunsPage::MAX_VALUES,
    }
}

/// The page of runs; warns of runs that it does not show.
pub fn viewer_page(viewed: ViewedRuns) -> String {
    for [run, reason] in &viewed.left_out {
        warn(&format!("run {run} is not shown: {reason}"));
    }
    let title = format!("Runs of {}", viewed.index);
    page(Kind::Runs, &title, &RunsPage::new(viewed))
}

/// Writes the page of runs, if requested, into the output folder of another command, whose page
/// links to it. Returns its address relative to the folder. A failure to read the runs is only a
/// warning, since the results of the command do not depend on the page.
///
/// # Errors
/// [`Failure::BadInput`] if the file cannot be written.
pub fn write_view(
    output: &OutputDir,
    options: Option<ViewOptions>,
    global: &Global,
) -> Result<Option<&'static str>, Failure> {
    let Some(options) = options else {
        return Ok(None);
    };
    match global.watched(|watch| view_runs(&options, watch)) {
        Ok(viewed) => {
            output.bytes(VIEWER, viewer_page(viewed))?;
            Ok(Some(VIEWER))
        }
        Err(failure) => {
            warn(&format!("{VIEWER} is not written: {failure}"));
            Ok(None)
        }
    }
}
