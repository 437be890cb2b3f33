//! How fine ice has to be under a runner on hexahedra of its own.

use crate::Problem;
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;

/// Cells of ice over half the patch that leave as much error as the runner's own hexahedra do; `None` where it has no such.
///
/// With n of these over half the patch, along or across, whichever has fewer, and errors like 1 / cells^2 on each side by its share of
/// what gives, w = (1 - nu^2) / E over the sum of both, the runner's is w / n^2, as that of n / sqrt(w) cells of ice.
pub(crate) fn own_cells(problem: &Problem, patch: &Patch) -> Option<f64> {
    let elastic = problem.runner.elastic.as_ref()?;
    let solid = elastic.solid.as_ref()?;
    let ice = &problem.ice;
    let give = |poisson: f64, young: f64| (1.0 - poisson * poisson) / young;
    let runner = give(elastic.poissons_ratio, elastic.youngs_modulus);
    let share = runner / (runner + give(ice.poissons_ratio, ice.youngs_modulus));
    let across = [patch.y.low, patch.y.high];
    let of = |stretch: &Stretch| {
        let [dx, dy] = solid.largest_face([stretch.low, stretch.high], across);
        (stretch.half() / dx).min(patch.y.half() / dy)
    };
    let cells = patch.x.iter().map(of).reduce(f64::min)?;
    Some(cells / share.sqrt())
}
