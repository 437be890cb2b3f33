//! `kufe runs init`: a commented mapping, guessed from samples.

use std::path::PathBuf;

use kufe_jobs::Failure;

use crate::output::global::Global;

const EXAMPLES: &str = "\
Example:
  kufe runs init raw/monday_01.csv -o mapping.toml";

/// Arguments of `kufe runs init`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Files of one run, one a logger
    #[arg(required = true)]
    pub samples: Vec<PathBuf>,
    /// The mapping to write
    #[arg(long, short, value_name = "FILE", default_value = "mapping.toml")]
    pub out: PathBuf,
}

/// Guesses and writes.
///
/// # Errors
/// [`Failure::BadInput`] with the file.
pub fn run(args: &Args, _global: &Global) -> Result<(), Failure> {
    Err(Failure::Usage(format!(
        "{}: nothing is guessed yet",
        args.out.display()
    )))
}
