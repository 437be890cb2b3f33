//! The errors of a table once it is solved, and its further forms.

use std::path::{Path, PathBuf};
use std::time::Duration;

use kufe::jobs::{Failure, percent, table::Solver};
use kufe::plot::short;
use kufe::results::TableSummary;
use kufe_lut::{AxisKind, Mode, Point, Quantity, SweepResult, Table};

use crate::terminal::Global;

/// Reports the errors of a written table, and fails where one is larger than requested.
///
/// # Errors
/// [`Failure::NotConverged`] where the interpolation or a solve stayed short of the request.
pub fn finish(
    swept: &SweepResult,
    solver: &Solver,
    out: &Path,
    written: &[PathBuf],
    (solves, time): (usize, Duration),
    global: &Global,
) -> Result<(), Failure> {
    let table = &swept.table;
    let summary = TableSummary::new(table, solves, time.as_secs_f64());
    let summary = summary?;
    global.print(&summary, || {
        let files = std::iter::once(out).chain(written.iter().map(PathBuf::as_path));
        let files: String = files.map(|path| format!("{}\n", path.display())).collect();
        files + &in_words(&summary, table)
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

/// How many solves stayed short of the solver's tolerance, and the worst.
fn short_of(table: &Table, tolerance: f64) -> Option<String> {
    // The film's own error adds to that of the groove, to which the tolerance applies.
    let times = if table.is_sliding() { 2.0 } else { 1.0 };
    let allowed = times * tolerance;
    let errors = table.solves();
    let errors = errors.map(|solve| (solve.point, solve.figures.relative_error()));
    let short: Vec<(Point, f64)> = errors.filter(|(_, error)| *error > allowed).collect();
    let (place, worst) = short.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let plural = if short.len() == 1 { "" } else { "s" };
    Some(format!(
        "{} solve{plural} stayed short of the {}'s tolerance of {}, the worst with an estimated error of {} at {place}",
        short.len(),
        in_a_sentence(table.judged()),
        percent(allowed),
        percent(*worst),
    ))
}

fn in_a_sentence(judged: Quantity) -> &'static str {
    match judged {
        Quantity::PMax => "peak pressure",
        _ => "coefficient of friction",
    }
}

fn in_words(summary: &TableSummary, table: &Table) -> String {
    let percent = |error: Option<f64>| match error {
        Some(error) => format!("{:.3} %", 100.0 * error),
        None => "not measured".into(),
    };
    let axes = table.axes();
    let (mut ranges, mut names) = (String::new(), Vec::new());
    for kind in AxisKind::ALL {
        if let Some(range) = axes.range(kind, axes.fz()[0]) {
            let [low, high] = range.map(short);
            ranges += &format!("  {:<21} {low} to {high}\n", kind.key());
            names.push(kind.key());
        }
    }
    let worst = match table.interpolation_error(table.judged(), Mode::Smooth) {
        Ok(Some(error)) => {
            let place = error.max_at.named();
            let place = place.map(|(key, value)| format!("{key} = {}", short(value)));
            let place = place.collect::<Vec<_>>().join(", ");
            format!(" (smooth: largest at {place})")
        }
        _ => String::new(),
    };
    let sizes = axes.shape().into_iter().map(|size| size.to_string());
    let sizes: Vec<String> = sizes.collect();
    let by_boundary_elements = match summary.by_boundary_elements {
        0 => String::new(),
        count => format!(", {count} of them by boundary elements"),
    };
    format!(
        "{ranges}  nodes                 {} ({}), {} checks between them\n  \
         solver error          {} of the {}, estimated\n  \
         interpolation error   {} smooth, {} bilinear, measured at the checks{worst}\n  \
         time                  {:.1} s for {} solves{by_boundary_elements}\n",
        sizes.join(" x "),
        names.join(" x "),
        summary.checks,
        percent(Some(table.solver_error())),
        in_a_sentence(table.judged()),
        percent(summary.interpolation_smooth),
        percent(summary.interpolation_bilinear),
        summary.seconds,
        summary.solves,
    )
}
