//! The solution of steady sliding.

use crate::accuracy::estimators::grid_convergence_index;
use crate::{Error, Measure, Solution};

/// Cross-section of the contact patch at one place along the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Place along the runner [m].
    pub x: f64,
    /// Width of the contact [m].
    pub width: f64,
    /// Pressure averaged over the width [Pa].
    pub pressure: f64,
}

/// A runner that slides steadily towards +x on ice that yields.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidingSolution {
    /// The contact: pressures, and gaps over the groove.
    pub contact: Solution,
    /// The groove, and the position of the runner in it.
    pub groove: Groove,
    /// The largest of the relative errors of peak pressure, groove's depth and ploughing force;
    /// infinite for a single mesh.
    pub relative_error: f64,
}

/// The groove of a runner that slides: the section that remains in the ice, the ploughing force,
/// and the patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Groove {
    /// Largest plastic depth behind the runner, including the groove of earlier ones [m].
    pub deepest: Measure,
    /// Ploughing force, the drag that deepens the groove [N]: F = H A with the area A of the
    /// section added, or the integral of pressure times the runner's slope. The mean of both for a
    /// rigid runner, the first for an elastic one.
    pub ploughing: Measure,
    /// Front end of the patch ahead of the lowest point [m].
    pub front: Measure,
    /// Back end of the patch ahead of the lowest point; negative if it lies behind [m].
    pub back: Measure,
    /// Centre of pressure ahead of the lowest point [m].
    pub load_ahead: Measure,
    /// The lowest point of the tilted runner, along x [m].
    pub lowest: f64,
    /// Cross-section of the remaining groove.
    pub profile: GrooveProfile,
    /// Plastic depth at the nodes of the contact's surface [m].
    pub depth: Vec<f64>,
    /// The patch from its front to its back.
    pub sections: Vec<Section>,
    /// Sections of coarser solutions; `None` if a single mesh was solved.
    pub coarser: Option<Coarser<Vec<Section>>>,
    /// History of all meshes.
    pub meshes: Vec<SlidingMesh>,
}

/// A value in two coarser solutions, from which its error is estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Coarser<T> {
    /// Value on the mesh before the last.
    pub before: T,
    /// Value on the last mesh without the area between its nodes and the rims.
    pub plain: T,
    /// Refinement ratio of the last mesh to the mesh before.
    pub refined: f64,
}

impl<T> Coarser<T> {
    /// Error of a figure that is `value` on the last mesh: the grid convergence index of the last
    /// two meshes, and the change by the area between nodes and rims on the last one, added in
    /// quadrature.
    ///
    /// The index alone is not sufficient: two meshes may agree by chance, depending on the
    /// positions of nodes next to rims.
    pub fn error(&self, value: f64, of: impl Fn(&T) -> f64) -> f64 {
        let by_mesh = grid_convergence_index(of(&self.before), value, self.refined);
        by_mesh.hypot(of(&self.plain) - value)
    }
}

/// One mesh of a sliding contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingMesh {
    /// Unknowns.
    pub dofs: usize,
    /// Nodes in contact.
    pub contact_nodes: usize,
    /// Corrections of the contact plane's response by the bodies.
    pub corrections: usize,
    /// Conjugate-gradient iterations of all corrections.
    pub iterations: usize,
    /// Ratio of the sum of the forces' changes in the last correction to the load.
    pub residual: f64,
    /// Groove's depth on this mesh alone [m].
    pub groove_depth: f64,
    /// Ploughing force on this mesh alone, from the plastic work per distance [N].
    pub plastic_work: f64,
    /// Ploughing force on this mesh alone from pressures and the slope of the undeformed runner
    /// [N].
    pub ploughing_by_slope: f64,
}

/// A sliding contact while it is being solved.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidingIterate {
    /// Pressure at which the ice yields [Pa].
    pub hardness: f64,
    /// Number of the mesh, counted from the coarsest.
    pub level: usize,
    /// Number of unknowns.
    pub dofs: usize,
    /// Relative error on the previous meshes; `None` for less than two.
    pub error_before: Option<f64>,
    /// Corrections so far; 0 on the contact plane alone.
    pub corrections: usize,
    /// Ratio of the sum of the forces' changes in the last correction to the load.
    pub residual: f64,
    /// Normal force [N].
    pub fz: f64,
    /// Present [`Groove::ploughing`] [N].
    pub ploughing: f64,
    /// Present [`Groove::sections`].
    pub sections: Vec<Section>,
}

// The section of the groove of an earlier runner.

/// Depth of a groove over its section across the sliding direction.
///
/// Linear between the places, 0 outside the first and the last.
#[derive(Clone, Debug, PartialEq)]
pub struct GrooveProfile {
    y: Vec<f64>,
    depth: Vec<f64>,
}

impl GrooveProfile {
    /// Depths [m] at ascending places `y` [m], two or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for places that do not ascend, a depth that is negative or not finite,
    /// or too few of them.
    pub fn new(y: Vec<f64>, depth: Vec<f64>) -> Result<Self, Error> {
        let bad = Error::out_of_range;
        if y.len() < 2 || y.len() != depth.len() {
            let count = y.len().min(depth.len()) as f64;
            return Err(bad(
                "places of a groove",
                count,
                "2 or more, each with a depth",
            ));
        }
        if let Some(pair) = y
            .windows(2)
            .find(|pair| !(pair[1] > pair[0] && pair[1].is_finite()))
        {
            return Err(bad("place in a groove", pair[1], "places that ascend"));
        }
        if let Some(&wrong) = depth.iter().find(|d| !(**d >= 0.0 && d.is_finite())) {
            return Err(bad("depth of a groove", wrong, "0 m or more"));
        }
        Ok(GrooveProfile { y, depth })
    }

    /// Places across [m].
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// Depths at the places [m].
    pub fn depth(&self) -> &[f64] {
        &self.depth
    }

    /// Depth at `y` [m].
    pub fn at(&self, y: f64) -> f64 {
        let next = self.y.partition_point(|&place| place < y);
        if next == self.y.len() || (next == 0 && self.y[0] > y) {
            return 0.0;
        }
        if next == 0 {
            return self.depth[0];
        }
        let share = (y - self.y[next - 1]) / (self.y[next] - self.y[next - 1]);
        self.depth[next - 1] + share * (self.depth[next] - self.depth[next - 1])
    }

    /// Largest depth [m].
    pub fn deepest(&self) -> f64 {
        self.depth.iter().copied().fold(0.0, f64::max)
    }

    /// Area of the section [m2].
    pub fn area(&self) -> f64 {
        let trapezoid =
            |k: usize| 0.5 * (self.depth[k] + self.depth[k + 1]) * (self.y[k + 1] - self.y[k]);
        (0..self.y.len() - 1).map(trapezoid).sum()
    }

    /// Whether it is symmetric about y = 0, to rounding of its depth.
    pub(crate) fn mirror_symmetric(&self) -> bool {
        let slack = 1e-9 * self.deepest();
        self.y
            .iter()
            .all(|&y| (self.at(y) - self.at(-y)).abs() <= slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_has_its_area_depth_and_mirror_image() -> Result<(), Error> {
        let groove = GrooveProfile::new(vec![-1.0, 0.0, 1.0], vec![0.0, 2.0, 0.0])?;
        assert_eq!(
            (groove.area(), groove.deepest(), groove.at(0.25)),
            (2.0, 2.0, 1.5)
        );
        assert_eq!((groove.at(-1.5), groove.at(1.5)), (0.0, 0.0));
        assert!(groove.mirror_symmetric());
        assert!(!GrooveProfile::new(vec![-1.0, 0.5, 1.0], vec![0.0, 2.0, 0.0])?.mirror_symmetric());
        for (y, depth) in [
            (vec![0.0], vec![1.0]),
            (vec![0.0, 0.0], vec![1.0, 1.0]),
            (vec![0.0, 1.0], vec![1.0, -1.0]),
            (vec![0.0, 1.0], vec![1.0, f64::NAN]),
            (vec![0.0, f64::NAN], vec![1.0, 1.0]),
        ] {
            assert!(GrooveProfile::new(y, depth).is_err());
        }
        Ok(())
    }
}
