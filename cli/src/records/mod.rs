//! `kufe runs`: import of recordings; gathering, checks, alignment and display of runs.

mod align;
mod check;
mod gather;
mod import;
mod init;
mod view;

use kufe::jobs::Failure;

use crate::terminal::Global;

/// Arguments of `kufe runs`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand, Debug)]
enum Command {
    /// Write a commented mapping, guessed from samples of the files
    Init(init::Args),
    /// Import recordings of other programs as runs
    Import(import::Args),
    /// Collect the runs of several folders in one index
    Gather(gather::Args),
    /// Check runs for faults and anomalies, with remedies
    Check(check::Args),
    /// Align runs to a common distance along their track, or estimate the track from them
    Align(align::Args),
    /// Show runs over distance and time on one page, overlaid, with the model's curves
    View(view::Args),
}

/// Runs the subcommand.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match &args.command {
        Command::Init(args) => init::run(args, global),
        Command::Import(args) => import::run(args, global),
        Command::Gather(args) => gather::run(args, global),
        Command::Check(args) => check::run(args, global),
        Command::Align(args) => align::run(args, global),
        Command::View(args) => view::run(args, global),
    }
}
