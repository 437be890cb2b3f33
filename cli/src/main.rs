//! The `kufe` command: `main` -> `run` -> one module per command, with its arguments.

mod about;
mod bodies;
mod friction;
mod info;
mod lut;
mod output;
mod press;
mod records;
mod report;
mod runs;
mod terminal;
mod text;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use kufe::jobs::Failure;

use crate::about::{completions, examples, init, schema};
use crate::bodies::{export, hull, mesh};
use crate::friction::icehouse;
use crate::runs::{discover, evaluate, fit, simulate, validate};
use crate::terminal::{Global, check_stdout, error_text, note};

/// Contact pressure, lookup tables, friction and dynamics of runners on ice.
#[derive(Parser)]
#[command(name = "kufe", version, propagate_version = true)]
struct Cli {
    #[command(flatten)]
    /// Options that every command takes.
    global: Global,
    #[command(subcommand)]
    /// What to do.
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one contact problem and write its pressure map
    Press(press::Args),
    /// Compare two solved contacts: maps, cuts and figures
    Compare(press::compare::Args),
    /// Write a parametric runner as a hull file, or check a scanned one
    Hull(hull::Args),
    /// Write the hexahedra of ice and runner, with their quality
    Mesh(mesh::Args),
    /// Write a contact problem for another solver
    Export(export::Args),
    /// Print the main figures of a file
    Info(info::Args),
    /// Make, draw, query and export lookup tables
    Lut(lut::Args),
    /// Write a commented case, table or model file to start from
    Init(init::Args),
    /// Friction of a case, or the fit of friction over pressure
    Friction(friction::Args),
    /// Coefficient of friction of each specimen, from gliding runs
    Icehouse(icehouse::Args),
    /// Fit friction to recorded runs
    Fit(fit::Args),
    /// Compare the friction model with runs it was not fitted to
    Validate(validate::Args),
    /// Losses of each driver over a straight glide
    Evaluate(evaluate::Args),
    /// Drive a sled down a track; make the sample data
    Simulate(simulate::Args),
    /// Find the effect that is missing in a model, name it and add it
    Discover(discover::Args),
    /// Import, gather, check, align and show recorded runs
    Runs(records::Args),
    /// Print the keys of files and results as JSON schemas
    Schema(schema::Args),
    /// Write one page of the results of another command
    Report(report::Args),
    /// Show a contact in the browser and solve it again with sliders
    View(view::Args),
    /// Print a completion script for a shell
    Completions(completions::Args),
    /// Write the manual pages
    Man(completions::ManArgs),
}

fn run(cli: Cli) -> Result<(), Failure> {
    let Cli { global, command } = cli;
    global.apply()?;
    if global.verbose {
        let threads = rayon::current_num_threads();
        note(&format!(
            "{} with {threads} threads",
            env!("CARGO_PKG_VERSION")
        ));
    }
    match command {
        Command::Press(args) => press::run(&args, &global),
        Command::Compare(args) => press::compare::run(&args, &global),
        Command::Hull(args) => hull::run(&args, &global),
        Command::Mesh(args) => mesh::run(&args, &global),
        Command::Export(args) => export::run(&args, &global),
        Command::Info(args) => info::run(&args, &global),
        Command::Lut(args) => lut::run(&args, &global),
        Command::Init(args) => init::run(&args, &global),
        Command::Friction(args) => friction::run(&args, &global),
        Command::Icehouse(args) => icehouse::run(&args, &global),
        Command::Fit(args) => fit::run(&args, &global),
        Command::Validate(args) => validate::run(&args, &global),
        Command::Evaluate(args) => evaluate::run(&args, &global),
        Command::Simulate(args) => simulate::run(&args, &global),
        Command::Discover(args) => discover::run(&args, &global),
        Command::Runs(args) => records::run(&args, &global),
        Command::Schema(args) => schema::run(&args, &global),
        Command::Report(args) => report::run(&args, &global),
        Command::View(args) => view::run(&args, &global),
        Command::Completions(args) => completions::run(&args, examples::added(Cli::command())),
        Command::Man(args) => completions::man(&args, &global, examples::added(Cli::command())),
    }
}

/// Prints an error of the arguments, or the help, and ends the process. Control characters in the
/// arguments are escaped.
fn exit(error: clap::Error) -> ! {
    if std::env::args().any(|word| word.contains(char::is_control)) {
        error_text(&error.render().to_string());
        std::process::exit(error.exit_code());
    }
    error.exit()
}

fn main() -> ExitCode {
    let matches = examples::added(Cli::command())
        .try_get_matches()
        .unwrap_or_else(|error| exit(lut::explained(error)));
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| exit(error));
    match run(cli).and_then(|()| check_stdout()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            note(&failure.to_string());
            failure.exit_code()
        }
    }
}
