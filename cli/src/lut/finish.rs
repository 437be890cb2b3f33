//! What a table is worth once it is solved, and its further forms.

use std::path::Path;

use kufe_jobs::Failure;
use kufe_lut::{Mode, Point, Quantity, Swept, Table};
use serde_json::{Value, json};

use crate::lut::export::Forms;
use crate::output::global::Global;
use crate::output::say::say;

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
        say(&format!("{summary:#}\n"));
    } else if !global.quiet {
        say(&format!("{}\n", out.display()));
        for path in &written {
            say(&format!("{}\n", path.display()));
        }
        say(&format!("{}\n", in_words(&summary)));
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
