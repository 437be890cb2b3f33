//! The `kufe` command: `main` -> `run` -> one module a command.

mod failure;
mod info;
mod outline;
mod output;
mod pressure_exr;
mod pressure_map;
mod pressure_png;
mod staging;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use failure::Failure;

/// Contact pressure, lookup tables, friction and dynamics of runners on ice.
#[derive(Parser)]
#[command(name = "kufe", version, about, propagate_version = true)]
struct Cli {
    #[command(flatten)]
    global: output::Global,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Say what a file holds
    Info(info::Args),
}

fn run(cli: Cli) -> Result<(), Failure> {
    let Cli { global, command } = cli;
    global.apply()?;
    match command {
        Command::Info(args) => info::run(&args, &global),
    }
}

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("kufe: {failure}");
            failure.exit_code()
        }
    }
}
