//! The `kufe` command: `main` -> `run` -> one module a command.

mod about;
mod bodies;
mod cli;
mod friction;
mod info;
mod lut;
mod output;
mod press;
mod records;
mod report;
mod runs;
mod terminal;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};
use kufe::jobs::Failure;

use crate::about::{completions, examples, init, schema};
use crate::bodies::{export, hull, mesh};
use crate::cli::{Cli, Command};
use crate::friction::icehouse;
use crate::runs::{discover, evaluate, fit, simulate, validate};
use crate::terminal::{check_stdout, error_text, note};

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

/// Prints an error of the arguments, or the help, and ends the process. Control characters of the
/// arguments do not reach the terminal.
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
