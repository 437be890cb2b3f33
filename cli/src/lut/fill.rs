//! `kufe lut TABLE.toml`: the whole table in one process.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kufe_jobs::table::{Solver, Wanted};
use kufe_lut::{Mode, Point, Quantity, Swept, Table};
use serde_json::{Value, json};

use super::export::{Forms, write_table};
use crate::failure::Failure;
use crate::output::Global;
use crate::watched::watched;

/// Arguments of `kufe lut` without a subcommand.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table file (docs/lut-format.md)
    #[arg(required = true)]
    table: Option<PathBuf>,
    /// Where the table goes [default: the table file's name with .lut]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    forms: Forms,
}

/// Solves every point that is not on disk yet and writes the table.
///
/// # Errors
/// As [`super::run`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let Some(path) = &args.table else {
        return Err(Failure::Usage("kufe lut: which table file?".into()));
    };
    let wanted = Wanted::read(path)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| path.with_extension("lut"));
    let started = Instant::now();
    let (solver, filled) = watched(global, |watch| {
        let solver = Solver::new(&wanted, watch)?;
        let filled = kufe_jobs::table::fill(&wanted, &solver, &out, watch)?;
        Ok::<_, Failure>((solver, filled))
    })?;
    write_table(&filled.swept.table, &out)?;
    filled.clear()?;
    let seconds = started.elapsed().as_secs_f64();
    let solves = filled.solves;
    finish(
        &filled.swept,
        solver.tolerance(),
        &out,
        &args.forms,
        Spent { solves, seconds },
        global,
    )
}

/// What a table cost.
pub struct Spent {
    /// Contacts solved.
    pub solves: usize,
    /// Wall time [s].
    pub seconds: f64,
}

/// Writes the further forms, tells what the table is worth, and fails where it is less than was asked.
///
/// # Errors
/// [`Failure::NotConverged`] where the interpolation or a solve stayed short of what was asked.
pub fn finish(
    swept: &Swept,
    solver_tolerance: f64,
    out: &Path,
    forms: &Forms,
    spent: Spent,
    global: &Global,
) -> Result<(), Failure> {
    let written = forms.write(&swept.table, out)?;
    let summary = summary(&swept.table, &spent)?;
    if global.json {
        println!("{summary:#}");
    } else if !global.quiet {
        println!("{}", out.display());
        for path in &written {
            println!("{}", path.display());
        }
        println!("{}", in_words(&summary));
    }
    let interpolation = swept.shortfall.as_ref().map(ToString::to_string);
    let reasons: Vec<String> = interpolation
        .into_iter()
        .chain(short_of(&swept.table, solver_tolerance))
        .collect();
    if reasons.is_empty() {
        return Ok(());
    }
    Err(Failure::NotConverged(format!(
        "{}: {}; the table was written with its measured errors",
        out.display(),
        reasons.join("; ")
    )))
}

/// How many solves stayed short of the solver's tolerance, and the worst.
fn short_of(table: &Table, tolerance: f64) -> Option<String> {
    let nodes = table.axes().points();
    let nodes = nodes.iter().zip(table.nodes());
    let checks = table
        .checks()
        .iter()
        .map(|check| (&check.point, &check.solved));
    let short: Vec<(&Point, f64)> = nodes
        .chain(checks)
        .map(|(point, solved)| (point, solved.p_max_error.abs() / solved.p_max.abs()))
        .filter(|(_, error)| *error > tolerance)
        .collect();
    let worst = short.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "{} solves stayed short of the peak pressure's tolerance of {tolerance:.2e}, the worst with an estimated error of \
         {:.2e} at {}",
        short.len(),
        worst.1,
        worst.0
    ))
}

fn summary(table: &Table, spent: &Spent) -> Result<Value, Failure> {
    let error = |mode| {
        let measured = table.interpolation_error(Quantity::PMax, mode);
        let measured = measured.map_err(Failure::bad_input)?;
        Ok::<_, Failure>(measured.map(|measured| measured.max))
    };
    Ok(json!({
        "nodes": table.nodes().len(),
        "fz_values": table.axes().fz().len(),
        "curvature_values": table.axes().curvature().len(),
        "rocker_radius_values": table.axes().rocker_radius().map(<[f64]>::len),
        "checks": table.checks().len(),
        "interpolation_asked": table.interpolation_asked,
        "interpolation_smooth": error(Mode::Smooth)?,
        "interpolation_bilinear": error(Mode::Bilinear)?,
        "solver_p_max": table.solver_error(),
        "solves": spent.solves,
        "seconds": spent.seconds,
        "version": table.version,
    }))
}

fn in_words(summary: &Value) -> String {
    let percent = |key: &str| match summary[key].as_f64() {
        Some(value) => format!("{:.3} %", 100.0 * value),
        None => "not measured".into(),
    };
    let rocker = match summary["rocker_radius_values"].as_u64() {
        Some(n) => format!(" x {n}"),
        None => String::new(),
    };
    format!(
        "  nodes                 {} x {}{rocker} (force x curvature), {} checks between them\n  \
         solver error          {} of the peak pressure, estimated\n  \
         interpolation error   {} smooth, {} bilinear, measured at the checks\n  \
         time                  {:.1} s for {} solves",
        summary["fz_values"],
        summary["curvature_values"],
        summary["checks"],
        percent("solver_p_max"),
        percent("interpolation_smooth"),
        percent("interpolation_bilinear"),
        summary["seconds"].as_f64().unwrap_or(0.0),
        summary["solves"],
    )
}
