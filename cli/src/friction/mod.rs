//! `kufe friction`: friction of a runner, and its fit to experiments and gliding runs.

mod fit;
pub mod icehouse;
mod optimum;
mod point;
mod sliding;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use kufe::jobs::{Failure, Located};

use crate::terminal::{Global, misspelt};

/// Arguments of `kufe friction`.
#[derive(clap::Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Args {
    #[command(subcommand)]
    task: Option<Task>,
    #[command(flatten)]
    point: point::Args,
}

#[derive(clap::Subcommand, Debug)]
enum Task {
    /// Fit a quadratic mu(p) to experiments, with errors in both
    Fit(fit::Args),
}

/// Runs the fit, or solves the cases.
///
/// # Errors
/// [`Failure::BadInput`], [`Failure::NotConverged`], [`Failure::Usage`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if let Some(Task::Fit(args)) = &args.task {
        return fit::run(args, global);
    }
    let case = args.point.cases.first().map(|case| case.to_string_lossy());
    if let Some(text) = case.and_then(|case| misspelt(&case, &["fit"])) {
        return Err(Failure::Usage(text));
    }
    args.point.check_complete()?;
    match (args.point.groove, args.point.optimise.is_empty()) {
        (true, true) => sliding::run(&args.point, global),
        (true, false) => optimum::run(&args.point, global),
        (false, _) => point::run(&args.point, global),
    }
}

/// Opens a table.
fn open(path: &Path) -> Result<BufReader<File>, Failure> {
    let file = kufe_files::open_regular(path).in_file(path)?;
    Ok(BufReader::new(file))
}
