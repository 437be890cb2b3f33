//! What a runner's own hexahedra leave of errors, and how fine ice under them has to be.

use crate::Problem;
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;

/// A runner's own hexahedra beside a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OwnCells {
    /// Over half the patch: along, across, or of half their height over half of its narrower side, whichever are fewest.
    cells: f64,
    /// The runner's share of what gives: (1 - nu^2) / E over the sum of both.
    share: f64,
}

/// Largest error of a peak over w / (1 - w) / n^2 of 24 contacts of a paraboloid whose truth is known: 2 to 6 cells over half
/// the patch, runners of 6 to 75 GPa on ice of 9, an edge or a face's middle at the lowest place.
const LARGEST: f64 = 0.7;
/// What a cell's height counts beside its length and width: three times as high ones leave as much as [`LARGEST`] says of cubes, twice as
/// high ones two thirds of it.
const LOW: f64 = 0.5;
/// Fewest cells of ice, so that three meshes from two cells on tell an order.
const FEWEST: f64 = 4.0;

impl OwnCells {
    /// Those of a problem's runner under `patch`; `None` where it has none.
    pub fn new(problem: &Problem, patch: &Patch) -> Option<Self> {
        let elastic = problem.runner.elastic.as_ref()?;
        let solid = elastic.solid.as_ref()?;
        let ice = &problem.ice;
        let give = |poisson: f64, young: f64| (1.0 - poisson * poisson) / young;
        let runner = give(elastic.poissons_ratio, elastic.youngs_modulus);
        let share = runner / (runner + give(ice.poissons_ratio, ice.youngs_modulus));
        let across = [patch.y.low, patch.y.high];
        let of = |stretch: &Stretch| {
            let [dx, dy, dz] = solid.largest_cell([stretch.low, stretch.high], across);
            let (along, across) = (stretch.half(), patch.y.half());
            (along / dx)
                .min(across / dy)
                .min(along.min(across) / (LOW * dz))
        };
        let cells = patch.x.iter().map(of).reduce(f64::min)?;
        Some(OwnCells { cells, share })
    }

    /// Cells of ice over half the patch that leave as much error as the runner's own hexahedra do: with errors like 1 / cells^2 on
    /// each side by its share w of what gives, the runner's is w / n^2, as that of n / sqrt(w) cells of ice. Finer ice tells nothing of
    /// what these miss, and shows the edges of their faces as ridges.
    pub fn ice_cells(self) -> f64 {
        (self.cells / self.share.sqrt()).max(FEWEST)
    }

    /// What faces that cannot follow the runner's own curved give leave of a peak, relative.
    ///
    /// Under a contact of curvature 1 / R the runner's part of it is w / R, which faces of size h miss by sagittas like w h^2 / R. The ice
    /// alone has to press them out: by pressures like E_i / a times as much, with E_i = E* / (1 - w) and a peak of (2 / pi) E* a / R. So the error is
    /// C w / (1 - w) / n^2 with n = a / h, and C is [`LARGEST`].
    pub fn peak_error(self) -> f64 {
        LARGEST * self.share / (1.0 - self.share) / (self.cells * self.cells)
    }

    /// The same of the approach, which sagittas of either sign do not move: the runner's part w of it, C w / n^2.
    pub fn approach_error(self) -> f64 {
        LARGEST * self.share / (self.cells * self.cells)
    }
}
