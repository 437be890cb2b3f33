//! The stiffness of a body as an operator.

use std::sync::Arc;

use kufe_fem::{MatrixFree, TensorOperator, to_components, to_nodes};

use crate::RunnerSolid;

/// K of a body; displacements and forces stand component after component.
pub(crate) enum Stiffness {
    /// Hexahedra of a tensor grid.
    Tensor(TensorOperator),
    /// Hexahedra in the columns and layers of a tensor grid, but of other heights; the grid says what its faces hold.
    Mapped {
        grid: TensorOperator,
        hexahedra: MatrixFree,
    },
    /// Hexahedra in no order.
    Solid(Arc<RunnerSolid>),
}

/// Vectors that products with a stiffness reuse: two node by node, and the forces of cells on their corners.
#[derive(Default)]
pub(crate) struct StiffnessWork {
    displacement: Vec<f64>,
    force: Vec<f64>,
    corners: Vec<f64>,
}

impl Stiffness {
    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => 3 * grid.node_count(),
            Stiffness::Solid(solid) => 3 * solid.mesh().points.len(),
        }
    }

    /// Unknowns that neither faces nor a solid's own clamps hold.
    pub fn free_dofs(&self) -> usize {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => grid.free_dofs(),
            Stiffness::Solid(solid) => solid.map.free_count(),
        }
    }

    /// The tensor grid of the body, or the one whose columns and layers it has.
    pub fn grid(&self) -> Option<&TensorOperator> {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => Some(grid),
            Stiffness::Solid(_) => None,
        }
    }

    /// Vectors for [`Stiffness::apply`].
    pub fn work(&self) -> StiffnessWork {
        let length = match self {
            Stiffness::Tensor(_) => 0,
            Stiffness::Mapped { .. } | Stiffness::Solid(_) => self.len(),
        };
        StiffnessWork {
            displacement: vec![0.0; length],
            force: vec![0.0; length],
            corners: Vec::new(),
        }
    }

    /// Sets the entries that faces or a solid's own clamps hold to 0.
    pub fn mask(&self, u: &mut [f64]) {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => grid.mask(u),
            Stiffness::Solid(solid) => {
                let nodes = solid.mesh().points.len();
                for (entry, u) in u.iter_mut().enumerate() {
                    if solid
                        .map
                        .index(3 * (entry % nodes) + entry / nodes)
                        .is_none()
                    {
                        *u = 0.0;
                    }
                }
            }
        }
    }

    /// `out` = K `u`, with 0 on entries that faces or a solid's own clamps hold.
    pub fn apply(&self, u: &[f64], out: &mut [f64], work: &mut StiffnessWork) {
        match self {
            Stiffness::Tensor(grid) => grid.apply(u, out),
            Stiffness::Mapped { grid, hexahedra } => {
                to_nodes(u, &mut work.displacement);
                hexahedra.apply_with(&work.displacement, &mut work.force, &mut work.corners);
                to_components(&work.force, out);
                grid.mask(out);
            }
            Stiffness::Solid(solid) => {
                to_nodes(u, &mut work.displacement);
                solid.stiffness.apply(&work.displacement, &mut work.force);
                let free = solid.map.restrict(&work.force);
                work.force.fill(0.0);
                solid.map.extend(&free, &mut work.force);
                to_components(&work.force, out);
            }
        }
    }
}
