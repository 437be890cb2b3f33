//! `kufe runs import`: recordings of other programs brought into kufe's form.

use std::path::PathBuf;

use kufe_jobs::Failure;

use crate::output::global::Global;

const EXAMPLES: &str = "\
Example:
  kufe runs import mapping.toml -o runs/";

/// Arguments of `kufe runs import`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Which files the runs are in, and what their channels are called
    pub mapping: PathBuf,
    /// Folder for runs.csv and one file a run
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
}

/// Reads, converts, resamples and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file, channel, row, value and what was expected.
pub fn run(args: &Args, _global: &Global) -> Result<(), Failure> {
    Err(Failure::Usage(format!(
        "{}: nothing is imported yet",
        args.mapping.display()
    )))
}
