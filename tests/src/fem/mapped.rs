//! Preconditioner for mapped grids.

use kufe_fem::{
    BeamModes, FastDiagonal, FixedFaces, Material, TensorOperator, to_components, to_nodes,
};
use kufe_mesh::TensorGrid;

/// [`FastDiagonal`] of a straight grid, applied to a body with the same numbering of nodes, with
/// optional [`BeamModes`] for slender bodies.
///
/// The stiffness of the mapped body and that of the straight grid are spectrally equivalent with
/// the constants of the map. Iteration counts therefore depend on the slope of its flanks and not on
/// the refinement. Vectors hold three numbers a node, node by node, as those of [`kufe_fem::Body`].
#[derive(Clone, Debug)]
pub struct MappedPreconditioner {
    fast: FastDiagonal,
    operator: TensorOperator,
    /// Coarse space, added to the result of the fast diagonalisation.
    pub beam: Option<BeamModes>,
    r: Vec<f64>,
    z: Vec<f64>,
    modal: Vec<f64>,
    scratch: Vec<f64>,
}

impl MappedPreconditioner {
    /// From the straight grid that represents the body: its columns, and levels at their mean
    /// heights [m].
    ///
    /// `fixed` gives the faces whose displacements are zero. The operator of a component that no
    /// face fixes is singular; `shift` [1/m^2] times its mass is added, about 1 / length^2 of the
    /// body. Use zero if every component is fixed.
    pub fn new(grid: &TensorGrid, material: Material, fixed: FixedFaces, shift: f64) -> Self {
        let mut operator = TensorOperator::new(grid, material, fixed);
        let axis = &mut operator.axes[0];
        for (k, m) in axis.stiffness.iter_mut().zip(&axis.mass) {
            for d in 0..3 {
                k[d] += shift * m[d];
            }
        }
        let fast = FastDiagonal::new(&operator, None);
        let dofs = 3 * operator.node_count();
        Self {
            modal: vec![0.0; fast.mode_count()],
            scratch: vec![0.0; fast.scratch_len()],
            r: vec![0.0; dofs],
            z: vec![0.0; dofs],
            fast,
            operator,
            beam: None,
        }
    }

    /// `z` = P^-1 `r`; zero on the fixed faces.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let nodes = self.operator.node_count();
        assert_eq!((r.len(), z.len()), (3 * nodes, 3 * nodes));
        to_components(r, &mut self.r);
        self.operator.mask(&mut self.r);
        self.fast
            .apply(&self.r, &mut self.z, &mut self.modal, &mut self.scratch);
        to_nodes(&self.z, z);
        if let Some(beam) = &self.beam {
            let mut motion = vec![0.0; beam.count()];
            beam.project(r, &mut motion, &mut Vec::new());
            beam.solve(&mut motion);
            beam.add_motion(&motion, z);
        }
    }
}
