//! An elastic body under or over the contact plane: what it weighs against displacements, and what it answers to forces.

use std::sync::Arc;

use faer::Mat;
use kufe_fem::{Body as Hexahedra, End, Material, MatrixFree, SparseStiffness, TensorOperator};

use crate::bodies::columns::{Columns, Side};
use crate::bodies::stiffness::{Stiffness, StiffnessWork};
use crate::bodies::trace::Trace;
use crate::precondition::inverse::Inverse;
use crate::precondition::mounted::MountedInverse;
use crate::precondition::planewise::PlanewiseInverse;
use crate::precondition::work::InverseWork;

/// A body with its stiffness K, a preconditioner M of it, and the trace B with which it meets the contact plane.
///
/// Plane values have one number for each node of the contact plane, x fastest; displacement vectors hold component after
/// component.
pub(crate) struct ElasticBody {
    pub stiffness: Stiffness,
    /// K of all displacements assembled: what is multiplied with where it is there.
    pub assembled: Option<Arc<SparseStiffness>>,
    pub inverse: Inverse,
    pub trace: Trace,
    /// Young's modulus and Poisson's ratio; of the ice where a bed lies under it.
    pub material: Material,
    /// Entries held beside what the stiffness holds: those of the preconditioner's clamps.
    pub held: Vec<usize>,
    /// Forces from outside on the body [N]; none where empty.
    pub load: Vec<f64>,
}

/// Vectors that one body's products and preconditioner reuse.
pub(crate) struct BodyWork {
    stiffness: StiffnessWork,
    inverse: InverseWork,
}

impl ElasticBody {
    /// A body on a tensor grid that nothing but faces of its operator hold.
    pub fn on_grid(
        operator: TensorOperator,
        material: Material,
        side: Side,
        columns: Columns,
    ) -> Self {
        let end = match side {
            Side::Below => End::High,
            Side::Above => End::Low,
        };
        let inverse = PlanewiseInverse::new(&operator, end, columns, side.sign(), material);
        ElasticBody {
            inverse: Inverse::Planewise(Box::new(inverse)),
            trace: trace_on_grid(&operator, side, columns),
            stiffness: Stiffness::Tensor(operator),
            assembled: None,
            material,
            held: Vec::new(),
            load: Vec::new(),
        }
    }

    /// A body above the plane with a preconditioner that knows its mount: entries that its clamps hold, and forces from
    /// outside (none where empty) [N].
    pub fn mounted(
        operator: TensorOperator,
        inverse: MountedInverse,
        material: Material,
        columns: Columns,
        (held, load): (Vec<usize>, Vec<f64>),
    ) -> Self {
        ElasticBody {
            inverse: Inverse::Mounted(Box::new(inverse)),
            trace: trace_on_grid(&operator, Side::Above, columns),
            stiffness: Stiffness::Tensor(operator),
            assembled: None,
            material,
            held,
            load,
        }
    }

    /// The same body on hexahedra in the same columns and layers, but of other heights.
    pub fn on_mapped(mut self, hexahedra: &Hexahedra) -> Self {
        if let Stiffness::Tensor(grid) = self.stiffness {
            let hexahedra = MatrixFree::new(hexahedra);
            self.stiffness = Stiffness::Mapped { grid, hexahedra };
        }
        self
    }

    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.stiffness.len()
    }

    /// Unknowns that nothing holds.
    pub fn free_dofs(&self) -> usize {
        self.stiffness.free_dofs() - self.held.len()
    }

    /// The columns of the contact plane that the body's own nodes stand on.
    pub fn columns(&self) -> Option<Columns> {
        match self.trace {
            Trace::Nodes { columns, .. } => Some(columns),
            Trace::Means(_) => None,
        }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> BodyWork {
        BodyWork {
            stiffness: self.stiffness.work(),
            inverse: self.inverse.work(),
        }
    }

    /// `out` = K `u`, with 0 on held entries.
    pub fn apply(&self, u: &[f64], out: &mut [f64], work: &mut BodyWork) {
        match &self.assembled {
            Some(assembled) => {
                assembled.apply(u, out);
                self.stiffness.mask(out);
            }
            None => self.stiffness.apply(u, out, &mut work.stiffness),
        }
        self.held.iter().for_each(|&entry| out[entry] = 0.0);
    }

    /// `closing` += B M^-1 `residual`; `work` keeps what [`ElasticBody::finish`] goes on from.
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut BodyWork) {
        self.inverse.begin(residual, closing, &mut work.inverse);
    }

    /// `step` = M^-1 (residual - B^T m) for the residual that `work` was last begun with and the forces m on nodes.
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut BodyWork) {
        self.inverse.finish(multipliers, step, &mut work.inverse);
        self.held.iter().for_each(|&entry| step[entry] = 0.0);
    }

    /// `closing` += B M^-1 B^T f for the forces f on nodes; `work` forgets what it was begun with.
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut BodyWork) {
        self.inverse.respond(forces, closing, &mut work.inverse);
    }

    /// B M^-1 B^T between plane nodes, and the estimate of B K^-1 B^T that contact sets are predicted with [m/N].
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        self.inverse.green(nodes)
    }

    /// Which entries nothing holds; of a body on a tensor grid.
    pub fn free(&self) -> Option<Vec<bool>> {
        let mut ones = vec![1.0; self.len()];
        self.stiffness.grid()?.mask(&mut ones);
        self.held.iter().for_each(|&entry| ones[entry] = 0.0);
        Some(ones.iter().map(|&one| one > 0.0).collect())
    }

    /// Entries that faces, clamps or the mount hold, ascending.
    pub fn held_entries(&self) -> Vec<usize> {
        let mut ones = vec![1.0; self.len()];
        self.stiffness.mask(&mut ones);
        self.held.iter().for_each(|&entry| ones[entry] = 0.0);
        (0..ones.len())
            .filter(|&entry| ones[entry] == 0.0)
            .collect()
    }
}

/// The vertical displacements of a grid's highest nodes for a body below, of its lowest for one above.
fn trace_on_grid(operator: &TensorOperator, side: Side, columns: Columns) -> Trace {
    let [nx, ny, nz] = operator.shape();
    let plane = match side {
        Side::Below => nz - 1,
        Side::Above => 0,
    };
    Trace::Nodes {
        columns,
        start: (2 * nz + plane) * nx * ny,
        sign: side.sign(),
    }
}
