//! What can go wrong in a contact solve.

use crate::{Method, Solution};

/// Errors of the contact solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number of the problem is outside its range.
    #[error("{name} = {value}: expected {expected}")]
    OutOfRange {
        /// What the number is.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// A checking method was asked for a runner that it does not take.
    #[error(
        "{method:?} does not take this elastic runner: expected a rigid one, or the active set for one on the ice's columns"
    )]
    MethodNotForRunner {
        /// The method.
        method: Method,
    },
    /// A runner that nothing but loads hold was given an approach, or tilts.
    #[error("a runner without a mount needs a normal force and free tilt")]
    LoadsNeedFreeTilt,
    /// The runner cannot rest on the track under this load.
    #[error(
        "the load's line of action at x = {x} m, y = {y} m misses the hull, which spans x {x_min} to {x_max} m and y {y_min} to {y_max} m"
    )]
    LoadMissesHull {
        /// Line of action along the runner [m].
        x: f64,
        /// Line of action across [m].
        y: f64,
        /// Start of the hull [m].
        x_min: f64,
        /// End of the hull [m].
        x_max: f64,
        /// Right side of the hull [m].
        y_min: f64,
        /// Left side of the hull [m].
        y_max: f64,
    },
    /// The track is curved so tightly that the hull does not fit.
    #[error("a track of radius {radius} m does not take a hull that reaches to x = {reach} m")]
    TrackTooTight {
        /// Track radius [m].
        radius: f64,
        /// Farthest point of the hull [m].
        reach: f64,
    },
    /// Steady sliding was asked of a problem that it does not take.
    #[error("steady sliding does not take {reason}")]
    NotSliding {
        /// What it does not take.
        reason: &'static str,
    },
    /// The runner cannot be meshed on the ice's columns.
    #[error("the elastic runner cannot be meshed: {reason}")]
    RunnerMesh {
        /// The mesher's own words, with their numbers.
        reason: String,
    },
    /// The load exceeds what the whole surface bears at the stated hardness.
    #[error(
        "a load of {fz} N needs more than the {capacity} N that the hull's whole underside bears at the stated hardness"
    )]
    BeyondHardness {
        /// Normal force [N].
        fz: f64,
        /// Hardness times the area that could touch [N].
        capacity: f64,
    },
    /// The caller asked the solve to end.
    #[error("stopped before the end")]
    Stopped,
    /// The iteration stopped short of its tolerance.
    #[error(
        "not converged after {iterations} iterations: residual {residual:.2e}, asked {tolerance:.2e}"
    )]
    NotConverged {
        /// Iterations spent.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual asked.
        tolerance: f64,
    },
    /// The accuracy asked was not reached within the largest mesh allowed.
    #[error(
        "estimated error of the peak pressure {estimate:.2e} (relative) with {dofs} unknowns, asked {tolerance:.2e}"
    )]
    AccuracyNotReached {
        /// Unknowns of the finest solve.
        dofs: usize,
        /// Estimated relative error.
        estimate: f64,
        /// Relative error asked.
        tolerance: f64,
        /// The solution of the finest mesh, with that error.
        best: Box<Solution>,
    },
    /// The accuracy asked of a sliding contact was not reached within the largest mesh allowed.
    #[error(
        "estimated error {estimate:.2e} (relative; the largest of peak pressure, groove's depth and ploughing force) with {dofs} \
         unknowns, asked {tolerance:.2e}"
    )]
    SlidingAccuracyNotReached {
        /// Unknowns of the finest solve.
        dofs: usize,
        /// Estimated relative error.
        estimate: f64,
        /// Relative error asked.
        tolerance: f64,
    },
    /// The assembled stiffness does not fit into the memory that it may take.
    #[error(
        "the assembled stiffness of a body of {dofs} displacements needs {:.2} GB, {:.2} GB are left of what it may take; expected \
         a matrix-free one or a coarser mesh",
        *needed as f64 / 1e9,
        *limit as f64 / 1e9
    )]
    StiffnessTooLarge {
        /// Displacements of the body.
        dofs: usize,
        /// Memory that its matrix needs while it is made [bytes].
        needed: u64,
        /// Memory that the bodies before it left [bytes].
        limit: u64,
    },
    /// The graphics processor does not solve problems of this kind.
    #[cfg(feature = "gpu")]
    #[error(
        "a graphics processor solves for rigid runners by the accelerated method alone; found {found}"
    )]
    NotOnDevice {
        /// What it does not take.
        found: &'static str,
    },
    /// The graphics processor failed, or the mesh is too large for it.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Device(#[from] kufe_fem::Error),
}
