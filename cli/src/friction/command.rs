//! `kufe friction`: from a hull to its friction, and the fit of friction over pressure.

use kufe::jobs::Failure;

use crate::friction::{fit, optimum, point, sliding};
use crate::output::global::Global;

const EXAMPLES: &str = "\
Examples:
  kufe friction case.toml --v-mps 30 --alpha-rad 0.01      solve the contact; mu, F_x and the power lost
  kufe friction case.toml --v-mps 30 --model model.toml    with the model's law and effects
  kufe friction case.toml --groove --v-mps 5,20,35 --ice-c -10,-5,-1   groove and melt film over speed and temperature
  kufe friction a.toml b.toml --groove --v-mps 30 --ice-c -8   two runners side by side
  kufe friction case.toml --groove --v-mps 30 --ice-c -8 --optimise rocker_radius_m=15:60   the rocker with the least friction
  kufe friction fit experiments.csv -o out/                fit mu over pressure, written in model.toml's form";

/// Arguments of `kufe friction`.
#[derive(clap::Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = EXAMPLES)]
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

/// Runs whichever is asked.
///
/// # Errors
/// [`Failure::BadInput`], [`Failure::NotConverged`], [`Failure::Usage`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match &args.task {
        Some(Task::Fit(args)) => fit::run(args, global),
        None => {
            args.point.complete()?;
            match args.point.sliding() {
                Some(asked) if asked.optimise.is_empty() => sliding::run(&asked, global),
                Some(asked) => optimum::run(&asked, global),
                None => point::run(&args.point, global),
            }
        }
    }
}
