//! The command line: global options and the commands.

use std::path::Path;

use clap::{Parser, Subcommand};

use crate::terminal::Global;
use crate::{about, bodies, friction, info, lut, press, records, report, runs, view};

/// Contact pressure, lookup tables, friction and dynamics of runners on ice.
#[derive(Parser)]
#[command(name = "kufe", version, propagate_version = true)]
pub struct Cli {
    #[command(flatten)]
    /// Options that every command takes.
    pub global: Global,
    #[command(subcommand)]
    /// What to do.
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Solve one contact problem and write its pressure map
    Press(press::Args),
    /// Compare two solved contacts: maps, cuts and figures
    Compare(press::compare::Args),
    /// Write a parametric runner as a hull file, or check a scanned one
    Hull(bodies::hull::Args),
    /// Write the hexahedra of ice and runner, with their quality
    Mesh(bodies::mesh::Args),
    /// Write a contact problem for another solver
    Export(bodies::export::Args),
    /// Print the main figures of a file
    Info(info::Args),
    /// Make, draw, query and export lookup tables
    Lut(lut::Args),
    /// Write a commented case, table or model file to start from
    Init(about::init::Args),
    /// Friction of a case, or the fit of friction over pressure
    Friction(friction::Args),
    /// Coefficient of friction of each specimen, from gliding runs
    Icehouse(friction::icehouse::Args),
    /// Fit friction to recorded runs
    Fit(runs::fit::Args),
    /// Compare the friction model with runs it was not fitted to
    Validate(runs::validate::Args),
    /// Losses of each driver over a straight glide
    Evaluate(runs::evaluate::Args),
    /// Drive a sled down a track; make the sample data
    Simulate(runs::simulate::Args),
    /// Find the effect that is missing in a model, name it and add it
    Discover(runs::discover::Args),
    /// Bring recordings of other programs into kufe's form
    Runs(records::Args),
    /// Print the keys of files and results as JSON schemas
    Schema(about::schema::Args),
    /// Write one page of the results of another command
    Report(report::Args),
    /// Show a contact in the browser and solve it again with sliders
    View(view::Args),
    /// Print a shell's completion script
    Completions(about::completions::Args),
    /// Write the manual pages
    Man(about::completions::ManArgs),
}

/// The error of a word that is no file and nearly one of a command's `subcommands`.
pub fn misspelt(word: &str, subcommands: &[&str]) -> Option<String> {
    if Path::new(word).extension().is_some() || Path::new(word).exists() {
        return None;
    }
    let like = subcommands.iter();
    let like = like.map(|name| (strsim::jaro_winkler(word, name), name));
    let (_, name) = like
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "unrecognized subcommand '{word}'\n\n  tip: a similar subcommand exists: '{name}'"
    ))
}
