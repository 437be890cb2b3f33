//! `kufe lut`: makes, reads and exports lookup tables of contacts.

mod export;
mod fill;
mod plan;
mod query;
mod show;

use clap::error::ErrorKind;
use kufe::jobs::Failure;

use crate::terminal::{Global, misspelt};

/// The subcommands.
const SUBCOMMANDS: [&str; 6] = ["show", "query", "export", "plan", "run", "merge"];

/// Arguments of `kufe lut`.
#[derive(clap::Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    fill: fill::Args,
}

#[derive(clap::Subcommand, Debug)]
enum Command {
    /// Draw a table
    Show(show::Args),
    /// Interpolate a table at one contact
    Query(query::Args),
    /// Write a table in other formats
    Export(export::Args),
    /// Divide the points of a table into shards
    Plan(plan::PlanArgs),
    /// Solve one shard of a plan
    Run(plan::RunArgs),
    /// Merge the results of a plan into a table
    Merge(plan::MergeArgs),
}

/// An error of the arguments. If a misspelt subcommand was taken for a table file, the error says
/// so instead.
pub fn explained(error: clap::Error) -> clap::Error {
    let words: Vec<String> = std::env::args().skip(1).take(2).collect();
    let [command, word] = &words[..] else {
        return error;
    };
    match misspelt(word, &SUBCOMMANDS) {
        Some(text) if command == "lut" && error.kind() == ErrorKind::ArgumentConflict => {
            clap::Error::raw(ErrorKind::InvalidSubcommand, format!("{text}\n"))
        }
        _ => error,
    }
}

/// Runs the subcommand, or fills the table.
///
/// # Errors
/// [`Failure::BadInput`] for files, [`Failure::NotConverged`] if a contact or the interpolation
/// misses its accuracy, [`Failure::Partial`] if the work was interrupted and can be resumed.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match &args.command {
        None => fill::run(&args.fill, global),
        Some(Command::Show(args)) => show::run(args, global),
        Some(Command::Query(args)) => query::run(args, global),
        Some(Command::Export(args)) => export::run(args, global),
        Some(Command::Plan(args)) => plan::plan(args, global),
        Some(Command::Run(args)) => plan::run(args, global),
        Some(Command::Merge(args)) => plan::merge(args, global),
    }
}
