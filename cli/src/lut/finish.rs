//! The errors of a table once it is solved, and its further forms.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, percent};
use kufe::results::TableSummary;
use kufe_lut::{AxisKind, Mode, Point, Quantity, SweepResult, Table};

use crate::terminal::Global;

/// What a table cost.
pub struct Spent {
    /// Contacts solved.
    pub solves: usize,
    /// Wall time [s].
    pub seconds: f64,
}

/// Reports the errors of a written table, and fails where one is larger than requested.
///
/// # Errors
/// [`Failure::NotConverged`] where the interpolation or a solve stayed short of the request.
pub fn finish(
    swept: &SweepResult,
    solver_tolerance: f64,
    out: &Path,
    written: &[PathBuf],
    spent: Spent,
    global: &Global,
) -> Result<(), Failure> {
    let table = &swept.table;
    let summary = TableSummary::new(table, spent.solves, spent.seconds);
    let summary = summary.map_err(Failure::bad_input)?;
    global.print(&summary, || {
        let mut text = format!("{}\n", out.display());
        for path in written {
            text += &format!("{}\n", path.display());
        }
        text + &in_words(&summary, table)
    })?;
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
    // The film's own error adds to that of the groove, to which the tolerance applies.
    let allowed = if table.is_sliding() {
        2.0 * tolerance
    } else {
        tolerance
    };
    let short: Vec<(Point, f64)> = table
        .solves()
        .map(|solve| (solve.point, solve.figures.relative_error()))
        .filter(|(_, error)| *error > allowed)
        .collect();
    let worst = short.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "{} solve{} stayed short of the {}'s tolerance of {}, the worst with an estimated error of {} at {}",
        short.len(),
        if short.len() == 1 { "" } else { "s" },
        in_a_sentence(table.judged()),
        percent(allowed),
        percent(worst.1),
        worst.0
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
    let (mut sizes, mut names) = (String::new(), String::from("force x curvature"));
    for (size, name) in [
        (summary.rocker_radius_values, "rocker radius"),
        (summary.v_values, "speed"),
        (summary.ice_values, "ice temperature"),
    ] {
        if let Some(n) = size {
            sizes += &format!(" x {n}");
            names += &format!(" x {name}");
        }
    }
    let ranges: String = AxisKind::ALL
        .into_iter()
        .filter_map(|kind| {
            let values = table.axes().get(kind)?;
            let [low, high] = match kind {
                AxisKind::Curvature => table.axes().curvature_range(table.axes().fz()[0]),
                _ => [values[0], values[values.len() - 1]],
            };
            Some(format!("  {:<21} {low} to {high}\n", kind.key()))
        })
        .collect();
    let measured = table.interpolation_error(table.judged(), Mode::Smooth);
    let worst = match measured {
        Ok(Some(error)) => format!(" (smooth: largest at {})", error.max_at),
        _ => String::new(),
    };
    format!(
        "{ranges}  nodes                 {} x {}{sizes} ({names}), {} checks between them\n  \
         solver error          {} of the {}, estimated\n  \
         interpolation error   {} smooth, {} bilinear, measured at the checks{worst}\n  \
         time                  {:.1} s for {} solves{}\n",
        summary.fz_values,
        summary.curvature_values,
        summary.checks,
        percent(Some(table.solver_error())),
        in_a_sentence(table.judged()),
        percent(summary.interpolation_smooth),
        percent(summary.interpolation_bilinear),
        summary.seconds,
        summary.solves,
        match summary.by_boundary_elements {
            0 => String::new(),
            count => format!(", {count} of them by boundary elements"),
        }
    )
}
