//! What can go wrong in a contact solve.

use crate::grid::patch::COARSE;
use crate::options::AREA_WEIGHT;
use crate::{SlidingSolution, Solution};

/// A number in no more digits than it needs.
pub(crate) fn plain(value: f64) -> String {
    if value == 0.0 || (1e-4..1e9).contains(&value.abs()) {
        return value.to_string();
    }
    format!("{value:e}")
}

/// A share in per cent with three significant digits, however small.
fn percent(share: f64) -> String {
    let percent = 1e2 * share;
    if percent == 0.0 || !percent.is_finite() {
        return format!("{percent} %");
    }
    // As it is rounded: 9.996 is 10.0.
    let rounded = format!("{percent:.2e}");
    let power: i32 = rounded
        .rsplit_once('e')
        .and_then(|(_, power)| power.parse().ok())
        .unwrap_or(0);
    match 2 - power {
        digits @ 0..=8 => format!("{percent:.*} %", digits as usize),
        ..0 => format!("{percent:.0} %"),
        _ => format!("{rounded} %"),
    }
}

/// The figure whose error a solve is judged by, and how much larger than the peak's that error may
/// be.
fn watched(best: &Solution) -> (&'static str, f64) {
    match best.hardness {
        Some(hardness) if best.p_max >= hardness => (
            "the area (the peak is the ice's hardness)",
            1.0 / AREA_WEIGHT,
        ),
        _ => ("the peak pressure", 1.0),
    }
}

/// The size of cells that cannot be.
fn size(spacing: f64) -> String {
    if spacing > 0.0 {
        format!("{spacing:.3e} m or less")
    } else {
        "no size".into()
    }
}

/// Why the requested error is reached and the solution still refused.
fn coarse(reached: bool, finest: f64) -> String {
    if reached {
        format!(
            ", but somewhere the pressure needs cells of {finest:.2} times the size of those there, \
             less than the {COARSE} that pass; finer ones have too many unknowns, or the mesh was \
             graded anew too often"
        )
    } else {
        String::new()
    }
}

/// Errors of the contact solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number of the problem is outside its range.
    #[error("{name} = {}: expected {expected}", plain(*value))]
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A problem that has no answer, or none by this method, with its numbers and what is expected.
    #[error("{0}")]
    Unsuitable(String),
    /// A problem that may have an answer, which no mesh gave; with what is expected instead.
    #[error("{0}")]
    Unsolved(String),
    /// The problem is not one of steady sliding.
    #[error("steady sliding does not take {reason}")]
    NotSliding {
        /// What it does not take.
        reason: &'static str,
    },
    /// The load exceeds what the hull bears: at rest its whole underside, sliding what lies ahead
    /// of its lowest point and a little behind.
    #[error(
        "a load of {fz} N needs more than the {capacity} N that the hull bears on ice of this hardness"
    )]
    LoadExceedsHardness {
        /// Normal force [N].
        fz: f64,
        /// Most load that it bears [N].
        capacity: f64,
    },
    /// The contact needs cells that are too small.
    #[error(
        "the contact from {from:.3e} to {to:.3e} m needs cells of {}: expected lengths (ice, runner, waves, mount) that are nearer \
         to one another",
        size(*spacing)
    )]
    TooFine {
        /// Start of the line [m].
        from: f64,
        /// Its end [m].
        to: f64,
        /// Requested spacing, or the least that rounding allows there [m].
        spacing: f64,
    },
    /// The meshes give no contact that carries the load.
    #[error("no contact was found: {name} = {value:.6e}, expected {expected}")]
    NoAnswer {
        /// The figure that cannot be.
        name: &'static str,
        /// What the meshes give.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// The caller stopped the solve.
    #[error("stopped before the end")]
    Stopped,
    /// The iteration stopped short of its tolerance.
    #[error(
        "not converged after {iterations} iterations: residual {residual:.2e}, requested {tolerance:.2e}"
    )]
    NotConverged {
        /// Iterations spent.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Requested residual.
        tolerance: f64,
    },
    /// The far field of the half-space and the force under a given approach do not converge
    /// together.
    #[error(
        "the force under the given approach still changes by {change:.2e} (relative) after {rounds} far fields"
    )]
    FarField {
        /// Far fields that were made.
        rounds: usize,
        /// Relative change of the force between the last two.
        change: f64,
    },
    /// The requested accuracy was not reached within the largest mesh allowed.
    #[error(
        "estimated error of {} {} with {dofs} unknowns, requested {}{}",
        watched(best).0, percent(watched(best).1 * estimate), percent(watched(best).1 * tolerance),
        coarse(*estimate <= *tolerance, *finest)
    )]
    AccuracyNotReached {
        /// Unknowns of the finest solve.
        dofs: usize,
        /// Estimated relative error.
        estimate: f64,
        /// Requested relative error.
        tolerance: f64,
        /// Smallest cells that the pressure needs somewhere, over those there.
        finest: f64,
        /// The solution of the finest mesh, with that error.
        best: Box<Solution>,
    },
    /// The requested accuracy of a sliding contact was not reached within the largest mesh allowed.
    #[error(
        "estimated error {} (the largest of peak pressure, groove's depth and ploughing force) with {dofs} \
         unknowns, requested {}",
        percent(best.relative_error), percent(*tolerance)
    )]
    SlidingAccuracyNotReached {
        /// Unknowns of the finest solve.
        dofs: usize,
        /// Requested relative error.
        tolerance: f64,
        /// The solution of the finest mesh, with its error.
        best: Box<SlidingSolution>,
    },
    /// The assembled stiffness does not fit into the memory that it may take.
    #[error(
        "the assembled stiffness of a body of {dofs} displacements needs {:.2} GB, {:.2} GB remain of the limit; expected \
         a matrix-free one or a coarser mesh",
        *needed as f64 / 1e9,
        *limit as f64 / 1e9
    )]
    StiffnessTooLarge {
        /// Displacements of the body.
        dofs: usize,
        /// Memory that its matrix needs while it is made [bytes].
        needed: u64,
        /// Memory that remains after the bodies before it [bytes].
        limit: u64,
    },
}

impl Error {
    /// A runner that cannot be meshed, in the mesher's own words.
    pub(crate) fn runner_mesh<E: std::fmt::Display>(reason: E) -> Self {
        Error::Unsuitable(format!("the elastic runner cannot be meshed: {reason}"))
    }

    /// No patch settled in this many solutions of the contact plane.
    pub(crate) fn no_patch(rounds: usize) -> Self {
        Error::Unsolved(format!(
            "no patch settles under the load in {rounds} rounds: expected a line of action farther \
             from the hull's ends, or gentler ice"
        ))
    }

    /// A number of the problem outside its range.
    pub(crate) fn out_of_range(name: &'static str, value: f64, expected: &'static str) -> Self {
        Error::OutOfRange {
            name,
            value,
            expected,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_accuracy_is_told_with_three_digits_however_small() {
        for (share, reported) in [
            (0.416e-2, "0.416 %"),
            (1e-5, "0.00100 %"),
            (2.34e-7, "0.0000234 %"),
            (1e-12, "1.00e-10 %"),
            (0.099_96, "10.0 %"),
            (3.0, "300 %"),
            (12.345, "1234 %"),
            (0.0, "0 %"),
        ] {
            assert_eq!(percent(share), reported, "{share}");
        }
    }
}
