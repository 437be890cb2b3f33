//! `kufe lut TABLE.toml`: fills a table in one process.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kufe::jobs::table::{Solver, TableSpec};
use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe::plot::{percent, short};
use kufe::results::{TableInfo, TableSummary};
use kufe_files::resolved;
use kufe_lut::{AxisKind, Mode, Point, Quantity, SweepResult, Table};

use crate::lut::SUBCOMMANDS;
use crate::lut::export::Forms;
use crate::output::OutputFiles;
use crate::terminal::{Global, misspelt, warn};
use crate::text::document_text;

/// Measured relative error of the interpolation above which a table is warned about.
const MAX_INTERPOLATION: f64 = 0.1;

/// Arguments of `kufe lut` without a subcommand.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table file (docs/tables.md)
    #[arg(required = true)]
    table: Option<PathBuf>,
    /// File of the table [default: the table file's name with .lut]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    forms: Forms,
}

/// Solves every point that is not on disk yet and writes the table.
///
/// # Errors
/// As [`crate::lut::run`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let Some(path) = &args.table else {
        return Err(Failure::Usage("kufe lut: which table file?".into()));
    };
    if let Some(text) = misspelt(&path.to_string_lossy(), &SUBCOMMANDS) {
        return Err(Failure::Usage(text));
    }
    let spec = TableSpec::read(path)?;
    if spec.plan.get(AxisKind::RockerRadius).is_some() {
        args.forms.require_radius()?;
    }
    let out = args.out.clone();
    let out = out.unwrap_or_else(|| path.with_extension("lut"));
    let started = Instant::now();
    let (solver, filled, files) = global.watched(|watch| {
        let solver = Solver::new(&spec, LoadedCase::read(&spec.case)?, watch)?;
        let mut outputs = args.forms.paths(&out);
        outputs.push(out.clone());
        let files = OutputFiles::begin("lut", &solver.inputs(&spec)?, &outputs, global.force)?;
        let filled = kufe::jobs::table::fill(&spec, &solver, &resolved(&out), watch)?;
        Ok::<_, Failure>((solver, filled, files))
    })?;
    let written = args.forms.commit(&filled.swept.table, &out, files)?;
    filled.clear()?;
    let spent = (filled.solves, started.elapsed());
    finish(&filled.swept, &solver, &out, &written, spent, global)
}

/// Prints a summary of a written table, and fails if its errors are larger than requested.
///
/// # Errors
/// [`Failure::NotConverged`] if the interpolation or a solve misses the requested accuracy.
pub fn finish(
    swept: &SweepResult,
    solver: &Solver,
    out: &Path,
    written: &[PathBuf],
    (solves, time): (usize, Duration),
    global: &Global,
) -> Result<(), Failure> {
    let table = &swept.table;
    let seconds = time.as_secs_f64();
    let summary = TableSummary::new(table, solves, seconds)?;
    let contents = document_text(&TableInfo::new(table, None)?)?;
    let worst = table.interpolation_error(table.judged(), Mode::Smooth)?;
    if let Some(error) = worst.as_ref().filter(|error| error.max > MAX_INTERPOLATION) {
        warn(&format!(
            "between the nodes the {} is uncertain by up to {}: nodes closer together lower that, or from and to in place of values, or flush where the runner lies flush on the track",
            table.judged().title(),
            percent(error.max)
        ));
    }
    let worst = worst.map_or(String::new(), |error| {
        let place = error.max_at.named();
        let place = place.map(|(key, value)| format!("{key} = {}", short(value)));
        let place = place.collect::<Vec<_>>().join(", ");
        format!("smooth interpolation is least accurate at {place}\n")
    });
    global.print(&summary, || {
        let files = std::iter::once(out).chain(written.iter().map(PathBuf::as_path));
        let files: String = files.map(|path| format!("{}\n", path.display())).collect();
        format!("{files}{contents}{worst}{solves} solves in {seconds:.1} s\n")
    })?;
    let interpolation = swept.shortfall.as_ref().map(ToString::to_string);
    let solves = short_of(table, solver.tolerance());
    let reasons: Vec<String> = interpolation.into_iter().chain(solves).collect();
    if reasons.is_empty() {
        return Ok(());
    }
    Err(Failure::NotConverged(format!(
        "{}: {}; the table was written with its measured errors",
        out.display(),
        reasons.join("; ")
    )))
}

/// A message with the number of solves that miss the tolerance of the solver, and the worst; none
/// if all reach it.
fn short_of(table: &Table, tolerance: f64) -> Option<String> {
    // The tolerance applies to the groove; the error of the film is added to that of the groove.
    let factor = if table.is_sliding() { 2.0 } else { 1.0 };
    let allowed = factor * tolerance;
    let errors = table.solves();
    let errors = errors.map(|solve| (solve.point, solve.figures.relative_error()));
    let short: Vec<(Point, f64)> = errors.filter(|(_, error)| *error > allowed).collect();
    let (place, worst) = short.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let plural = if short.len() == 1 { "" } else { "s" };
    Some(format!(
        "{} solve{plural} stayed short of the {}'s tolerance of {}, the worst with an estimated error of {} at {place}",
        short.len(),
        match table.judged() {
            Quantity::PMax => "peak pressure",
            _ => "coefficient of friction",
        },
        percent(allowed),
        percent(*worst),
    ))
}
