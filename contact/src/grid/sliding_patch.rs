//! Where a sliding runner touches: a first guess, and the meshes for what was found.

use crate::Problem;
use crate::grid::first_guess::guess;
use crate::grid::patch::Patch;
use crate::problem::gap::Gap;

/// Wanted spacing along the runner over the even one: the front, where the ice begins to yield, needs finer cells than a smooth
/// contact.
const ALONG: f64 = 0.5;

/// How far beyond the back rim the patch is taken to end, over its length: of two nodes as far before and behind the lowest point the
/// one behind is not to be deepened, where ice hardly springs back.
const BEHIND: f64 = 2e-3;

/// Guesses the patch: as for elastic ice, but no deeper cut bears more than the hardness over half its ellipse, that ahead of the
/// lowest point.
pub(crate) fn sliding_guess(problem: &Problem, gap: &Gap) -> Patch {
    let hardness = problem.ice.hardness.unwrap_or(f64::INFINITY);
    let most = |length: f64, width: f64| hardness * std::f64::consts::PI / 8.0 * length * width;
    regular(guess(problem, gap, &most))
}

/// The patch whose rims are these [x low, x high, y low, y high]; zones of cells end half a cell beyond them, so that the nodes' shares
/// of the plane end where the ice yields.
pub(crate) fn fitted(mut patch: Patch, [low, high, right, left]: [f64; 4]) -> Patch {
    if let Some(first) = patch.x.first_mut() {
        first.low = (low - BEHIND * (high - low)).min(first.high);
    }
    if let Some(last) = patch.x.last_mut() {
        last.high = high.max(last.low);
    }
    (patch.y.low, patch.y.high) = (right, left);
    regular(patch)
}

/// The same patch with even cells, finer along than across, and finer still where the keel's curvature jumps.
fn regular(mut patch: Patch) -> Patch {
    for stretch in &mut patch.x {
        stretch.sizes = vec![[0.0, ALONG], [1.0, ALONG]];
    }
    patch.y.sizes.clear();
    patch.refined_at_corners()
}
