//! The `kufe` command: `main` -> `run` -> one module a command.

mod completions;
mod discover;
mod doctor;
mod evaluate;
mod examples;
mod fit;
mod friction;
mod hermite;
mod hull;
mod icehouse;
mod info;
mod init;
mod lut;
mod mesh;
mod outline;
mod output;
mod patches;
mod placed_hull;
mod press;
mod pressure_exr;
mod pressure_map;
mod pressure_png;
mod read_map;
mod reference;
mod report;
mod rim;
mod schema;
mod simulate;
mod sled_runs;
mod staging;
mod validate;
mod view;
mod volume_vtu;
mod watched;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use kufe_jobs::{Failure, case_file, failure};

const EXAMPLES: &str = "\
Examples:
  kufe press                        solve a built-in bobsled runner into out/
  kufe init case.toml               write a commented case to edit
  kufe press case.toml -o out/      solve it
  kufe report out/                  one page to look at: out/report.html
  kufe view                         the same with sliders that solve again
  kufe info out/pressure.exr        say what the map holds

Exit codes: 0 done, 2 wrong arguments, 3 bad input or unwritable output,
4 accuracy not reached, 5 partly done (run again to resume)";

/// Contact pressure, lookup tables, friction and dynamics of runners on ice.
#[derive(Parser)]
#[command(name = "kufe", version, propagate_version = true, after_help = EXAMPLES)]
struct Cli {
    #[command(flatten)]
    global: output::Global,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one contact problem and write its pressure map
    Press(press::Args),
    /// Write a parametric runner as a hull file
    Hull(hull::Args),
    /// Write the hexahedra of ice and runner, with their quality
    Mesh(mesh::Args),
    /// Say what a file holds
    Info(info::Args),
    /// Make, draw, query and export lookup tables
    Lut(lut::Args),
    /// Write a commented case, table or model file to start from
    Init(init::Args),
    /// Friction of a case, or the fit of friction over pressure
    Friction(friction::Args),
    /// Coefficient of friction by specimen from gliding runs
    Icehouse(icehouse::Args),
    /// Fit friction to recorded runs
    Fit(fit::Args),
    /// Compare the friction model with runs it was not fitted to
    Validate(validate::Args),
    /// What drivers lose beyond a straight glide
    Evaluate(evaluate::Args),
    /// Drive a sled down a track; make the sample data
    Simulate(simulate::Args),
    /// Find the effect that a model lacks, name it and add it
    Discover(discover::Args),
    /// Print the keys of case, table or model files as a JSON schema
    Schema(schema::Args),
    /// Write one page to look at, from what another command has written
    Report(report::Args),
    /// Look at a contact in the browser and solve it again with sliders
    View(view::Args),
    /// Say what this machine offers
    Doctor(doctor::Args),
    /// Print a shell's completion script
    Completions(completions::Args),
    /// Write the manual pages
    Man(completions::ManArgs),
}

fn run(cli: Cli) -> Result<(), Failure> {
    let Cli { global, command } = cli;
    global.apply()?;
    if global.verbose {
        let threads = rayon::current_num_threads();
        eprintln!("kufe: {} with {threads} threads", env!("CARGO_PKG_VERSION"));
    }
    match command {
        Command::Press(args) => press::run(&args, &global),
        Command::Hull(args) => hull::run(&args, &global),
        Command::Mesh(args) => mesh::run(&args, &global),
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
        Command::Schema(args) => schema::run(&args, &global),
        Command::Report(args) => report::run(&args, &global),
        Command::View(args) => view::run(&args, &global),
        Command::Doctor(args) => doctor::run(&args, &global),
        Command::Completions(args) => completions::run(&args, examples::added(Cli::command())),
        Command::Man(args) => completions::man(&args, &global, examples::added(Cli::command())),
    }
}

fn main() -> ExitCode {
    let matches = examples::added(Cli::command()).get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("kufe: {failure}");
            failure.exit_code()
        }
    }
}
