//! One elastic body of a contact on a tensor grid: stiffness, preconditioner, and the plane with which it touches.

use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;
use kufe_fem::{
    Body as Solid, End, Material, MatrixFree, SparseStiffness, TensorOperator, to_components,
    to_nodes,
};

use crate::bodies::columns::{Columns, Side};
use crate::bodies::elastic_body::ElasticBody;
use crate::precondition::mounted::MountedInverse;
use crate::precondition::planewise::PlanewiseInverse;

/// One elastic body, its preconditioner, and the plane with which it touches.
pub(crate) struct TensorBody {
    /// Tensor grid of the body itself, or the box that a mapped body is preconditioned by.
    pub operator: TensorOperator,
    /// The stiffness on mapped hexahedra, where the body is none of tensor shape.
    mapped: Option<Mutex<Mapped>>,
    /// The same or the operator's stiffness, assembled: what is multiplied with where it is there.
    pub assembled: Option<Arc<SparseStiffness>>,
    /// M, spectrally equivalent to the stiffness.
    inverse: Inverse,
    /// Index of the contact plane along z.
    plane: usize,
    /// Columns of the contact plane that the body stands on.
    pub columns: Columns,
    /// +1 below, -1 above: the gap shrinks by sign times the vertical displacement.
    sign: f64,
    /// Young's modulus and Poisson's ratio.
    pub material: Material,
    /// Entries held beside the operator's faces.
    held: Vec<usize>,
    load: Vec<f64>,
}

/// The preconditioner.
enum Inverse {
    Layered(Box<PlanewiseInverse>),
    Mounted(Box<MountedInverse>),
}

/// A matrix-free stiffness and vectors in its order, node by node.
struct Mapped {
    stiffness: MatrixFree,
    displacement: Vec<f64>,
    force: Vec<f64>,
}

impl TensorBody {
    /// A body that nothing but faces of its operator hold.
    pub fn new(operator: TensorOperator, material: Material, side: Side, columns: Columns) -> Self {
        let (end, sign) = match side {
            Side::Below => (End::High, 1.0),
            Side::Above => (End::Low, -1.0),
        };
        let inverse = PlanewiseInverse::new(&operator, end, columns, sign, material);
        let inverse = Inverse::Layered(Box::new(inverse));
        Self::with_inverse(operator, inverse, material, side, columns)
    }

    /// A body above the plane with a preconditioner that knows its mount.
    pub fn mounted(
        operator: TensorOperator,
        inverse: MountedInverse,
        material: Material,
        columns: Columns,
    ) -> Self {
        let inverse = Inverse::Mounted(Box::new(inverse));
        Self::with_inverse(operator, inverse, material, Side::Above, columns)
    }

    fn with_inverse(
        operator: TensorOperator,
        inverse: Inverse,
        material: Material,
        side: Side,
        columns: Columns,
    ) -> Self {
        let [_, _, nz] = operator.shape();
        let (plane, sign) = match side {
            Side::Below => (nz - 1, 1.0),
            Side::Above => (0, -1.0),
        };
        TensorBody {
            operator,
            mapped: None,
            assembled: None,
            inverse,
            plane,
            columns,
            sign,
            material,
            held: Vec::new(),
            load: Vec::new(),
        }
    }

    /// The same body on hexahedra in the same columns and layers, but of other heights.
    pub fn on_mapped(mut self, solid: &Solid) -> Self {
        let length = self.len();
        self.mapped = Some(Mutex::new(Mapped {
            stiffness: MatrixFree::new(solid),
            displacement: vec![0.0; length],
            force: vec![0.0; length],
        }));
        self
    }

    /// The same body with entries that the preconditioner's clamps hold, and forces from outside (none where empty) [N].
    pub fn held_at(mut self, held: Vec<usize>, load: Vec<f64>) -> Self {
        self.held = held;
        self.load = load;
        self
    }

    /// Whether the body's hexahedra are not those of its tensor grid.
    pub fn is_mapped(&self) -> bool {
        self.mapped.is_some()
    }

    /// Which entries nothing holds.
    pub fn free(&self) -> Vec<bool> {
        let mut ones = vec![1.0; self.len()];
        self.operator.mask(&mut ones);
        self.held.iter().for_each(|&entry| ones[entry] = 0.0);
        ones.iter().map(|&one| one > 0.0).collect()
    }

    /// The preconditioner of a body on its tensor grid that nothing but faces hold and no forces load.
    #[cfg(feature = "gpu")]
    pub fn plain_inverse(&self) -> Option<&PlanewiseInverse> {
        let plain = self.mapped.is_none() && self.held.is_empty() && self.load.is_empty();
        match &self.inverse {
            Inverse::Layered(inverse) if plain => Some(inverse),
            _ => None,
        }
    }

    /// Where the vertical displacements of the contact plane begin in this body's vector.
    fn plane_start(&self) -> usize {
        let [nx, ny, nz] = self.operator.shape();
        (2 * nz + self.plane) * nx * ny
    }

    /// Place of a plane node in this body's vector.
    fn entry(&self, node: usize) -> Option<usize> {
        let [i, j] = self.columns.local(node)?;
        Some(self.plane_start() + j * self.columns.count[0] + i)
    }

    /// Vertical displacement of the body's own plane nodes, 0 beside its columns.
    pub fn surface(&self, u: &[f64], plane_nodes: usize) -> Vec<f64> {
        (0..plane_nodes)
            .map(|node| self.entry(node).map_or(0.0, |entry| u[entry]))
            .collect()
    }
}

impl ElasticBody for TensorBody {
    fn len(&self) -> usize {
        3 * self.operator.node_count()
    }

    fn free_dofs(&self) -> usize {
        self.operator.free_dofs() - self.held.len()
    }

    fn apply(&self, u: &[f64], out: &mut [f64]) {
        if let Some(assembled) = &self.assembled {
            assembled.apply(u, out);
            self.operator.mask(out);
            self.held.iter().for_each(|&entry| out[entry] = 0.0);
            return;
        }
        let Some(mapped) = &self.mapped else {
            return self.operator.apply(u, out);
        };
        // The lock is never contended: one iteration runs at a time.
        let mut mapped = mapped.lock().unwrap_or_else(PoisonError::into_inner);
        let Mapped {
            stiffness,
            displacement,
            force,
        } = &mut *mapped;
        to_nodes(u, displacement);
        stiffness.apply(displacement, force);
        to_components(force, out);
        self.operator.mask(out);
        self.held.iter().for_each(|&entry| out[entry] = 0.0);
    }

    fn add_closing(&self, u: &[f64], closing: &mut [f64]) {
        let start = self.plane_start();
        let [nx, ny] = self.columns.count;
        for j in 0..ny {
            for i in 0..nx {
                closing[self.columns.node([i, j])] += self.sign * u[start + j * nx + i];
            }
        }
    }

    fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]) {
        for &(node, force) in forces {
            if let Some(entry) = self.entry(node) {
                out[entry] += self.sign * force;
            }
        }
    }

    fn begin(&self, residual: &[f64], closing: &mut [f64]) {
        match &self.inverse {
            Inverse::Layered(inverse) => inverse.begin(residual, closing),
            Inverse::Mounted(inverse) => inverse.begin(residual, closing),
        }
    }

    fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64]) {
        match &self.inverse {
            Inverse::Layered(inverse) => inverse.finish(multipliers, step),
            Inverse::Mounted(inverse) => inverse.finish(multipliers, step),
        }
        self.held.iter().for_each(|&entry| step[entry] = 0.0);
    }

    fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        match &self.inverse {
            Inverse::Layered(inverse) => inverse.green(nodes),
            Inverse::Mounted(inverse) => inverse.green(nodes),
        }
    }

    fn load(&self) -> &[f64] {
        &self.load
    }
}
