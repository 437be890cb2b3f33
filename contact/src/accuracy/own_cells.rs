//! The error due to a runner's own hexahedra, and the resolution of the ice that matches them.

use crate::Problem;
use crate::accuracy::watched::ErrorFloor;
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;

/// A runner's own hexahedra next to a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OwnCells {
    /// Number of cells over half the patch: the smallest of those along and across, and of half the
    /// cells' heights over half of the patch's narrower side.
    cells: f64,
    /// Ratio w of the runner's compliance (1 - nu^2) / E to that of both bodies.
    share: f64,
}

/// Bound of the ratio of a peak's relative error to w / (1 - w) / n^2. For 25 contacts of a
/// paraboloid with the exact peak by Hankel transforms (2 to 6 cells over half the patch, runners
/// of 6 to 75 GPa on ice of 9, an edge or a face's middle at the lowest point) the ratio is at most
/// 0.95 at two cells, 0.7 at three, 0.5 from four on.
const MAX_ERROR_RATIO: f64 = 1.0;
/// Weight of a cell's height relative to its length and width: the error of cells twice as high is
/// 2.5 times that of cubes, of cells three times as high four times.
const HEIGHT_WEIGHT: f64 = 0.5;
/// Smallest number of cells of ice, so that three meshes from two cells on determine an order.
const MIN_CELLS: f64 = 4.0;

impl OwnCells {
    /// The hexahedra of a problem's runner next to `patch`; `None` if it has none of its own.
    pub fn new(problem: &Problem, patch: &Patch) -> Option<Self> {
        let elastic = problem.runner.elastic.as_ref()?;
        let solid = elastic.solid.as_ref()?;
        let share = elastic.compliance() / problem.compliance();
        let across = [patch.y.low, patch.y.high];
        let of = |stretch: &Stretch| {
            let [dx, dy, dz] = solid.largest_cell([stretch.low, stretch.high], across);
            let (along, across) = (stretch.half(), patch.y.half());
            (along / dx)
                .min(across / dy)
                .min(along.min(across) / (HEIGHT_WEIGHT * dz))
        };
        let cells = patch.x.iter().map(of).reduce(f64::min)?;
        Some(OwnCells { cells, share })
    }

    /// Number of cells of ice over half the patch with the same error as the runner's own n: with
    /// errors proportional to 1 / cells^2 and to each body's fraction of the compliance, the
    /// runner's is w / n^2, the same as with n / sqrt(w) cells of ice. Finer ice gives no
    /// information on the runner's error, and resolves the edges of its faces as ridges.
    pub fn ice_cells(self) -> f64 {
        (self.cells / self.share.sqrt()).max(MIN_CELLS)
    }

    /// Relative errors due to faces that cannot follow the runner's deformation: C w / (1 - w) /
    /// n^2 of the peak.
    ///
    /// The runner takes the fraction w of a contact's curvature 1 / R, and n cells over half the
    /// patch a have an error of the surface of w h^2 / (4 R), h = a / n. The ice alone flattens it,
    /// with E_i = E* / (1 - w): a wave of the length of the patch, cos(2 x / a), needs pressures of
    /// E_i / a times its height, pi / 8 w / (1 - w) / n^2 of the peak 2 E* a / (pi R). C,
    /// [`MAX_ERROR_RATIO`], includes shorter waves. The error of the approach, to which waves of
    /// either sign do not contribute, is C w / n^2.
    pub fn error_floor(self) -> ErrorFloor {
        let runner = MAX_ERROR_RATIO * self.share / (self.cells * self.cells);
        ErrorFloor {
            peak: runner / (1.0 - self.share),
            approach: runner,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ElasticRunner, Ice, Load, Runner, RunnerSolid, Tilt};
    use kufe_mesh::{Paraboloid, TensorGrid};
    use std::sync::Arc;

    #[test]
    fn the_fewest_cells_of_three_directions_count_and_errors_go_with_their_square()
    -> Result<(), Box<dyn std::error::Error>> {
        let even = |size: f64, count: i32, from: f64| -> Vec<f64> {
            (0..=count).map(|i| from + size * f64::from(i)).collect()
        };
        let patch = Patch {
            x: vec![Stretch::even(-0.012, 0.012)],
            y: Stretch::even(-0.004, 0.004),
            motion: 0.0,
            corners: Vec::new(),
        };
        let of = |[dx, dy, dz]: [f64; 3], young: f64| -> Result<OwnCells, crate::Error> {
            let grid = TensorGrid {
                x: even(dx, 10, -5.0 * dx),
                y: even(dy, 10, -5.0 * dy),
                z: even(dz, 2, 0.0),
            };
            let fixed = |p: [f64; 3]| p[2] > 1.5 * dz;
            let solid = RunnerSolid::new(grid.hex_mesh(), young, 0.3, fixed)?;
            let flat = Paraboloid::new(1.0, 1.0).expect("radii");
            let mut runner = Runner::rigid(Arc::new(flat));
            runner.elastic = Some(ElasticRunner {
                solid: Some(Arc::new(solid)),
                ..ElasticRunner::fixed_at_top(young, 0.3, 0.0)
            });
            let load = Load::central(1.0, Tilt::Free);
            let problem = Problem::new(runner, Ice::half_space(9e9, 0.3), load);
            Ok(OwnCells::new(&problem, &patch).expect("hexahedra of its own"))
        };
        for (sizes, cells) in [
            ([3e-3, 5e-4, 1e-3], 4.0),
            ([3e-3, 2e-3, 1e-3], 2.0),
            ([3e-3, 5e-4, 8e-3], 1.0),
        ] {
            let found = of(sizes, 9e9)?;
            assert!((found.cells / cells - 1.0).abs() < 1e-9, "{found:?}");
            // As stiff as the ice: half of what gives.
            assert!((found.share - 0.5).abs() < 1e-12, "{found:?}");
            let error = MAX_ERROR_RATIO / (cells * cells);
            assert!((found.error_floor().peak / error - 1.0).abs() < 1e-9);
            assert!((found.error_floor().approach / error - 0.5).abs() < 1e-9);
        }
        // Three meshes of ice at the least, and more cells under steel.
        assert_eq!(of([3e-3, 2e-3, 1e-3], 9e9)?.ice_cells(), MIN_CELLS);
        let steel = of([3e-3, 5e-4, 1e-3], 210e9)?;
        let expected = 4.0 * (219.0f64 / 9.0).sqrt();
        assert!(
            (steel.ice_cells() / expected - 1.0).abs() < 1e-9,
            "{steel:?}"
        );
        Ok(())
    }
}
