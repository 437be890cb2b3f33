//! From a problem to steady sliding.

use crate::accuracy::scout::capacity;
use crate::groove::profile::GrooveProfile;
use crate::groove::sequence::SlidingMeshes;
use crate::groove::solution::SlidingSolution;
use crate::problem::check::check;
use crate::problem::gap::Gap;
use crate::solve::answered;
use crate::{Error, Method, Options, Problem};

/// Solves the steady sliding of a runner towards +x, on ice that yields at `problem.ice.hardness` H and keeps its plastic depth.
///
/// ```text
/// 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0,   sum of p dA = F_z
/// u_p never falls towards the back, and p = H where it grows;   ploughing force = H times the section that is added
/// ```
///
/// `before` is the groove in which the ice comes, one that an earlier runner left. Meshes are refined until the estimated errors of
/// peak pressure, groove depth and ploughing force are below `options.p_max_tolerance`; `options.progress` is told nothing. The
/// load's line of action stays where it is: a runner that is free to tilt turns until the pressure stands under it, and the drag's
/// own moment is not in the balance. What the runner's sides push up is not in it either.
///
/// # Errors
/// [`Error::NotSliding`] for ice without a hardness or of varying height, a checking method; those of
/// [`solve`](crate::solve()) for problems without an answer and answers that are none: [`Error::BeyondHardness`] too where the hull
/// bears the load at rest but not sliding; [`Error::NotConverged`], [`Error::NoPatch`], and
/// [`Error::SlidingAccuracyNotReached`] where the largest mesh allowed does not do.
///
/// ```
/// use std::sync::Arc;
/// use kufe_contact::{Ice, Load, Options, Problem, Runner, Tilt, slide};
/// use kufe_mesh::Paraboloid;
///
/// let mut ice = Ice::half_space(9.0e9, 0.33);
/// ice.hardness = Some(17.7e6);
/// let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.004)?));
/// let problem = Problem::new(runner, ice, Load::central(950.0, Tilt::LEVEL));
/// let solution = slide(&problem, None, &Options { cells: Some(8), ..Options::default() })?;
/// // A groove of 36 µm; ploughing it is some 5e-4 of the load.
/// assert!((solution.groove.deepest.value / 35.6e-6 - 1.0).abs() < 0.03);
/// assert!((solution.groove.ploughing.value / 950.0 / 4.77e-4 - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn slide(
    problem: &Problem,
    before: Option<&GrooveProfile>,
    options: &Options,
) -> Result<SlidingSolution, Error> {
    rayon::scope(|_| {
        let material = check(problem, options)?;
        refuse(problem, options)?;
        capacity(problem)?;
        let mirrored = before.is_none_or(GrooveProfile::mirror_symmetric);
        let gap = Gap::new(problem)?.mirrored_at_most([false, mirrored]);
        let solution = SlidingMeshes::scout(problem, gap, material, before, options)?.solve()?;
        Ok(SlidingSolution {
            contact: answered(problem, solution.contact)?,
            ..solution
        })
    })
}

/// What steady sliding does not take.
fn refuse(problem: &Problem, options: &Options) -> Result<(), Error> {
    if problem.ice.hardness.is_none() {
        return Err(Error::NotSliding {
            reason: "ice without a hardness",
        });
    }
    if problem.ice_surface.is_some() {
        return Err(Error::NotSliding {
            reason: "ice of varying height, on which no sliding is steady",
        });
    }
    if options.method != Method::Accelerated {
        return Err(Error::NotSliding {
            reason: "a checking method",
        });
    }
    Ok(())
}
