//! The errors of a table once it is solved, and its further forms.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, percent};
use kufe_lut::{Method, Mode, Point, Quantity, SweepResult, Table};
use serde_json::{Value, json};

use crate::output::global::Global;
use crate::output::say::say;

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
    let summary = summary(&swept.table, &spent)?;
    if global.json {
        say(&format!("{summary:#}\n"));
    } else if !global.quiet {
        say(&format!("{}\n", out.display()));
        for path in written {
            say(&format!("{}\n", path.display()));
        }
        say(&format!("{}\n", in_words(&summary, swept.table.judged())));
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

fn summary(table: &Table, spent: &Spent) -> Result<Value, Failure> {
    let error = |mode| {
        let measured = table.interpolation_error(table.judged(), mode);
        let measured = measured.map_err(Failure::bad_input)?;
        Ok::<_, Failure>(measured.map(|measured| measured.max))
    };
    let solver = format!("solver_{}", table.judged().name());
    Ok(json!({
        "nodes": table.axes().node_count(),
        "fz_values": table.axes().fz().len(),
        "curvature_values": table.axes().curvature().len(),
        "rocker_radius_values": table.axes().rocker_radius().map(<[f64]>::len),
        "v_values": table.axes().speed().map(<[f64]>::len),
        "ice_values": table.axes().ice_c().map(<[f64]>::len),
        "checks": table.checks().len(),
        "by_boundary_elements": table.solved_by(Method::BoundaryElements),
        "interpolation_requested": table.interpolation_requested,
        "interpolation_smooth": error(Mode::Smooth)?,
        "interpolation_bilinear": error(Mode::Bilinear)?,
        solver: table.solver_error(),
        "solves": spent.solves,
        "seconds": spent.seconds,
        "version": table.origin.version(),
    }))
}

fn in_words(summary: &Value, judged: Quantity) -> String {
    let percent = |key: &str| match summary[key].as_f64() {
        Some(value) => format!("{:.3} %", 100.0 * value),
        None => "not measured".into(),
    };
    let (mut sizes, mut names) = (String::new(), String::from("force x curvature"));
    for (key, name) in [
        ("rocker_radius_values", "rocker radius"),
        ("v_values", "speed"),
        ("ice_values", "ice temperature"),
    ] {
        if let Some(n) = summary[key].as_u64() {
            sizes += &format!(" x {n}");
            names += &format!(" x {name}");
        }
    }
    format!(
        "  nodes                 {} x {}{sizes} ({names}), {} checks between them\n  \
         solver error          {} of the {}, estimated\n  \
         interpolation error   {} smooth, {} bilinear, measured at the checks\n  \
         time                  {:.1} s for {} solves{}",
        summary["fz_values"],
        summary["curvature_values"],
        summary["checks"],
        percent(&format!("solver_{}", judged.name())),
        in_a_sentence(judged),
        percent("interpolation_smooth"),
        percent("interpolation_bilinear"),
        summary["seconds"].as_f64().unwrap_or(0.0),
        summary["solves"],
        match summary["by_boundary_elements"].as_u64() {
            Some(count @ 1..) => format!(", {count} of them by boundary elements"),
            _ => String::new(),
        }
    )
}
