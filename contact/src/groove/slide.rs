//! From a problem to steady sliding.

use crate::groove::profile::GrooveProfile;
use crate::groove::sequence::SlidingMeshes;
use crate::groove::solution::SlidingSolution;
use crate::problem::check::check;
use crate::problem::gap::Gap;
use crate::{Error, Method, Options, Problem};

/// Solves the steady sliding of a runner towards +x, on ice that yields at `problem.ice.hardness`.
pub fn slide(
    problem: &Problem,
    before: Option<&GrooveProfile>,
    options: &Options,
) -> Result<SlidingSolution, Error> {
    rayon::scope(|_| {
        let material = check(problem, options)?;
        refuse(problem, options)?;
        let mirrored = before.is_none_or(GrooveProfile::mirror_symmetric);
        let gap = Gap::new(problem)?.mirrored_at_most([false, mirrored]);
        SlidingMeshes::scout(problem, gap, material, before, options)?.solve()
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
    #[cfg(feature = "gpu")]
    if options.device.is_some() {
        return Err(Error::NotSliding {
            reason: "a graphics processor",
        });
    }
    Ok(())
}
