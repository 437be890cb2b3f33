//! `kufe runs view`: one page that shows recorded runs over time and distance.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::runs::run_inputs;
use kufe::jobs::view_runs::{ViewOptions, view_runs};
use serde::Serialize;

use crate::output::OutputFiles;
use crate::runs::{all_runs, viewer_page};
use crate::terminal::Global;
use crate::text::print_document;

/// Arguments of `kufe runs view`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Index of the runs
    pub runs: PathBuf,
    /// Model of the sled and its friction: its curves are shown too
    #[arg(long, short, value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// Only these runs (several with commas)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub run: Vec<String>,
    /// The page to write
    #[arg(long, short, value_name = "HTML", default_value = "view.html")]
    pub out: PathBuf,
}

/// A page that was written.
#[derive(Serialize)]
struct WrittenPage<'a> {
    written: &'a Path,
    runs: usize,
    left_out: Vec<[String; 2]>,
    rate_hz: f64,
    bytes: usize,
}

/// Reads the runs and writes the page.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, and where no run can be shown.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let mut inputs = run_inputs(&args.runs);
    inputs.extend(args.model.clone());
    let outputs = std::slice::from_ref(&args.out);
    let files = OutputFiles::begin("runs view", &inputs, outputs, global.force)?;
    let options = ViewOptions {
        model: args.model.clone(),
        only: args.run.clone(),
        ..all_runs(args.runs.clone())
    };
    let viewed = global.watched(|watch| view_runs(&options, watch))?;
    let mut written = WrittenPage {
        written: &args.out,
        runs: viewed.runs.len(),
        left_out: viewed.left_out.clone(),
        rate_hz: viewed.rate_hz,
        bytes: 0,
    };
    let html = viewer_page(viewed);
    written.bytes = html.len();
    files.bytes(&args.out, html.as_bytes())?;
    files.commit()?;
    print_document(&written, global)
}
