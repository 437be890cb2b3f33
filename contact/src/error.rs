//! Errors of a contact solve.

use crate::grid::patch::COARSE;
use crate::options::AREA_WEIGHT;
use crate::{SlidingSolution, Solution};

/// A number with the fewest digits that represent it.
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

/// The figure whose error is compared with the tolerance, and the factor by which its error may
/// exceed that of the peak.
fn watched(best: &Solution) -> (&'static str, f64) {
    match best.hardness {
        Some(hardness) if best.p_max >= hardness => (
            "the area (the peak is the ice's hardness)",
            1.0 / AREA_WEIGHT,
        ),
        _ => ("the peak pressure", 1.0),
    }
}

/// The required size of cells, in words.
fn size(spacing: f64) -> String {
    if spacing > 0.0 {
        format!("{spacing:.3e} m or less")
    } else {
        "no size".into()
    }
}

/// The reason why a solution is refused although the requested error is reached.
fn coarse(reached: bool, finest: f64) -> String {
    if reached {
        format!(
            ", but somewhere the pressure needs cells of {finest:.2} times the present size, less \
             than the accepted {COARSE}; finer cells have too many unknowns, or the mesh was graded \
             too often"
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
        /// Name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its admissible range.
        expected: &'static str,
    },
    /// A problem that has no solution, or none by this method; the text gives its numbers and what
    /// is expected.
    #[error("{0}")]
    Unsuitable(String),
    /// A problem that may have a solution, which no mesh gave; the text says what is expected.
    #[error("{0}")]
    Unsolved(String),
    /// The problem is not one of steady sliding.
    #[error("steady sliding does not take {reason}")]
    NotSliding {
        /// The part of the problem that steady sliding excludes.
        reason: &'static str,
    },
    /// The load exceeds the hull's capacity at this hardness: at rest that of the whole underside,
    /// in sliding that of the part ahead of its lowest point and a little behind.
    #[error(
        "a load of {fz} N is not below the {capacity} N that the hull bears on ice of this hardness"
    )]
    LoadExceedsHardness {
        /// Normal force [N].
        fz: f64,
        /// Largest load of the hull [N].
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
        /// Requested spacing, or the smallest that rounding allows there [m].
        spacing: f64,
    },
    /// The meshes give no contact that carries the load.
    #[error("no contact was found: {name} = {value:.6e}, expected {expected}")]
    NoAnswer {
        /// Name of the figure that is out of range.
        name: &'static str,
        /// Its value on the meshes.
        value: f64,
        /// Its admissible range.
        expected: &'static str,
    },
    /// The caller stopped the solve.
    #[error("stopped before the end")]
    Stopped,
    /// The iteration stopped short of its tolerance.
    #[error(
        "not converged after {iterations} iterations: {}residual {residual:.2e}, requested {tolerance:.2e}",
        if residual <= tolerance { "the contact set still changes, " } else { "" }
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
        /// Number of far fields computed.
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
        /// Smallest ratio anywhere of the cell size that the pressure needs to the present one.
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
    /// The assembled stiffness does not fit into the allowed memory.
    #[error(
        "the assembled stiffness of a body of {dofs} displacements needs {:.2} GB, {:.2} GB remain of the limit; expected \
         a matrix-free one or a coarser mesh",
        *needed as f64 / 1e9,
        *limit as f64 / 1e9
    )]
    StiffnessTooLarge {
        /// Displacements of the body.
        dofs: usize,
        /// Memory that assembling its matrix needs [bytes].
        needed: u64,
        /// Memory that remains after the previous bodies [bytes].
        limit: u64,
    },
}

impl Error {
    /// A runner that cannot be meshed, with the mesher's reason.
    pub(crate) fn runner_mesh<E: std::fmt::Display>(reason: E) -> Self {
        Error::Unsuitable(format!("the elastic runner cannot be meshed: {reason}"))
    }

    /// The patch did not converge in this many solutions of the contact plane.
    pub(crate) fn no_patch(rounds: usize) -> Self {
        Error::Unsolved(format!(
            "the contact patch under the load did not converge in {rounds} rounds: expected a line of \
             action farther from the hull's ends, or less uneven ice"
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
