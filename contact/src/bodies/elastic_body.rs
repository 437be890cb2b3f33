//! An elastic body under or over the contact plane: its stiffness, preconditioner and trace on the
//! plane.

use std::sync::Arc;

use faer::Mat;
use kufe_fem::{
    Body, Error, FixedFaces, Material, MatrixFree, Section, SparseStiffness, TensorOperator,
    to_components, to_nodes,
};
use kufe_mesh::TensorGrid;

use crate::RunnerSolid;
use crate::precondition::factored::{FactoredInverse, Mortar};
use crate::precondition::mounted::MountedInverse;
use crate::precondition::planewise::{Columns, InverseWork, PlanewiseInverse, Side};

/// A body with its stiffness K, a preconditioner M of K, and the trace B from its displacements to
/// the closing of the gap on the contact plane.
///
/// Plane values have one number for each node of the contact plane, x fastest; displacement vectors
/// hold component after component.
pub(crate) struct ElasticBody {
    pub stiffness: Stiffness,
    /// K of all displacements if assembled; products then use it.
    pub assembled: Option<Arc<SparseStiffness>>,
    pub inverse: Inverse,
    pub trace: Trace,
    /// Displacements that the preconditioner's clamps fix, in addition to those of the stiffness.
    pub fixed: Vec<usize>,
    /// External forces on the body [N]; empty without.
    pub load: Vec<f64>,
}

/// M^-1, spectrally equivalent to the inverse of the stiffness.
///
/// An application has two passes: `begin` returns the closing of the gap by M^-1 r. From it follow
/// the contact forces m, and `finish` returns M^-1 (r - B^T m). So one application is enough for
/// both.
pub(crate) enum Inverse {
    /// Inverse for a body that is constrained only on faces of its tensor grid.
    Planewise(Box<PlanewiseInverse>),
    /// Inverse for a body with a mount.
    Mounted(Box<MountedInverse>),
    /// Exact inverse for unstructured hexahedra.
    Factored(FactoredInverse),
}

/// Calls a method of whichever inverse a body has.
macro_rules! each {
    ($body:ident, $method:ident($($argument:expr),*)) => {
        match &$body.inverse {
            Inverse::Planewise(inverse) => inverse.$method($($argument),*),
            Inverse::Mounted(inverse) => inverse.$method($($argument),*),
            Inverse::Factored(inverse) => inverse.$method($($argument),*),
        }
    };
}

/// Vectors that one body's products and preconditioner reuse: displacements and forces by nodes,
/// and the forces of cells on their corners.
pub(crate) struct BodyWork {
    displacement: Vec<f64>,
    force: Vec<f64>,
    corners: Vec<f64>,
    inverse: InverseWork,
}

impl ElasticBody {
    /// A body on a tensor grid, fixed at faces of its operator only.
    pub fn on_grid(operator: TensorOperator, side: Side, columns: Columns) -> Self {
        let inverse = PlanewiseInverse::new(&operator, columns, side);
        let inverse = Inverse::Planewise(Box::new(inverse));
        ElasticBody::with_inverse(operator, inverse, side, columns)
    }

    /// A body on a tensor grid with this preconditioner, without clamps and external forces.
    pub fn with_inverse(
        operator: TensorOperator,
        inverse: Inverse,
        side: Side,
        columns: Columns,
    ) -> Self {
        // The trace has the vertical displacements of the highest nodes of a body below the plane,
        // of the lowest nodes of a body above it.
        let [nx, ny, nz] = operator.shape();
        let plane = match side {
            Side::Below => nz - 1,
            Side::Above => 0,
        };
        ElasticBody {
            trace: Trace::Nodes {
                columns,
                start: (2 * nz + plane) * nx * ny,
                sign: side.sign(),
            },
            inverse,
            stiffness: Stiffness::Tensor(operator),
            assembled: None,
            fixed: Vec::new(),
            load: Vec::new(),
        }
    }

    /// The same body on hexahedra in the same columns and layers, but of other heights.
    pub fn on_mapped(mut self, hexahedra: &Body) -> Self {
        if let Stiffness::Tensor(grid) = self.stiffness {
            let hexahedra = MatrixFree::new(hexahedra);
            self.stiffness = Stiffness::Mapped { grid, hexahedra };
        }
        self
    }

    /// Material of the body; that of the ice if it has a bed.
    pub fn material(&self) -> Material {
        match &self.stiffness {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => grid.material,
            Stiffness::Solid(solid) => solid.material(),
        }
    }

    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        self.stiffness.len()
    }

    /// Number of free displacements.
    pub fn free_dofs(&self) -> usize {
        self.stiffness.free_dofs() - self.fixed.len()
    }

    /// The columns of the contact plane on which the body has nodes; `None` for unstructured
    /// hexahedra.
    pub fn columns(&self) -> Option<Columns> {
        match self.trace {
            Trace::Nodes { columns, .. } => Some(columns),
            Trace::Means(_) => None,
        }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> BodyWork {
        let length = match self.stiffness {
            Stiffness::Tensor(_) => 0,
            Stiffness::Mapped { .. } | Stiffness::Solid(_) => self.len(),
        };
        BodyWork {
            displacement: vec![0.0; length],
            force: vec![0.0; length],
            corners: Vec::new(),
            inverse: each!(self, work()),
        }
    }

    /// `out` = K `u`, with 0 on fixed entries.
    pub fn apply(&self, u: &[f64], out: &mut [f64], work: &mut BodyWork) {
        match &self.assembled {
            Some(assembled) => {
                assembled.apply(u, out);
                self.stiffness.mask(out);
            }
            None => self.stiffness.apply(u, out, work),
        }
        self.fixed.iter().for_each(|&entry| out[entry] = 0.0);
    }

    /// First pass: `closing` += B M^-1 `residual`; `work` keeps the state for
    /// [`ElasticBody::finish`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut BodyWork) {
        each!(self, begin(residual, closing, &mut work.inverse));
    }

    /// Second pass: `step` = M^-1 (r - B^T m) for the residual r of the last
    /// [`ElasticBody::begin`] with `work` and the forces m on nodes.
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut BodyWork) {
        each!(self, finish(multipliers, step, &mut work.inverse));
        self.fixed.iter().for_each(|&entry| step[entry] = 0.0);
    }

    /// `closing` += B M^-1 B^T f for the forces f on nodes; overwrites the state in `work`.
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut BodyWork) {
        each!(self, respond(forces, closing, &mut work.inverse));
    }

    /// B M^-1 B^T between plane nodes, and the estimate of B K^-1 B^T for the prediction of contact
    /// sets [m/N].
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        each!(self, green(nodes))
    }

    /// Displacements that faces, clamps or the mount fix, ascending.
    pub fn fixed_dofs(&self) -> Vec<usize> {
        let mut ones = vec![1.0; self.len()];
        self.stiffness.mask(&mut ones);
        self.fixed.iter().for_each(|&entry| ones[entry] = 0.0);
        (0..ones.len())
            .filter(|&entry| ones[entry] == 0.0)
            .collect()
    }
}

/// Fixed faces: the ends and sides if `all_round` and those of z (low, high) if `z`, in all
/// components; mirror planes in their normal component.
pub(crate) fn fixed_faces(symmetry: [bool; 2], all_round: bool, z: [bool; 2]) -> FixedFaces {
    std::array::from_fn(|c| {
        let low = |axis: usize| if symmetry[axis] { c == axis } else { all_round };
        [[low(0), all_round], [low(1), all_round], z]
    })
}

// The stiffness of a body as an operator.

/// K of a body; displacements and forces are stored component after component.
pub(crate) enum Stiffness {
    /// Hexahedra of a tensor grid.
    Tensor(TensorOperator),
    /// Hexahedra in the columns and layers of a tensor grid, but of other heights; the grid has
    /// the fixed faces.
    Mapped {
        grid: TensorOperator,
        hexahedra: MatrixFree,
    },
    /// Unstructured hexahedra.
    Solid(Arc<RunnerSolid>),
}

impl Stiffness {
    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => 3 * grid.node_count(),
            Stiffness::Solid(solid) => 3 * solid.mesh().points.len(),
        }
    }

    /// Number of displacements that neither faces nor a solid's own clamps fix.
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

    /// Sets the displacements that faces or a solid's own clamps fix to 0.
    pub fn mask(&self, u: &mut [f64]) {
        match self {
            Stiffness::Tensor(grid) | Stiffness::Mapped { grid, .. } => grid.mask(u),
            Stiffness::Solid(solid) => {
                let nodes = solid.mesh().points.len();
                let free = |entry: usize| solid.map.index(3 * (entry % nodes) + entry / nodes);
                for (entry, u) in u.iter_mut().enumerate() {
                    if free(entry).is_none() {
                        *u = 0.0;
                    }
                }
            }
        }
    }

    /// `out` = K `u`, with 0 on entries that faces or a solid's own clamps fix.
    fn apply(&self, u: &[f64], out: &mut [f64], work: &mut BodyWork) {
        to_nodes(u, &mut work.displacement);
        match self {
            Stiffness::Tensor(grid) => return grid.apply(u, out),
            Stiffness::Mapped { hexahedra, .. } => {
                hexahedra.apply_with(&work.displacement, &mut work.force, &mut work.corners);
            }
            Stiffness::Solid(solid) => solid.stiffness.apply(&work.displacement, &mut work.force),
        }
        to_components(&work.force, out);
        self.mask(out);
    }
}

// Closing of the gap on the contact plane by a body's displacements.

/// B: the closing of the gap on the plane's nodes, x fastest, from displacements, component after
/// component. It is the vertical displacement times the sign of the body's side.
pub(crate) enum Trace {
    /// Nodes of the body that are nodes of the plane.
    Nodes {
        columns: Columns,
        /// Index of their first vertical displacement in the body's vector, x fastest.
        start: usize,
        /// +1 for a body below, -1 for one above.
        sign: f64,
    },
    /// Weighted means over the nodes of a body above with a mesh of its own.
    Means(Arc<Mortar>),
}

impl Trace {
    /// `closing` += B `u`.
    pub fn add_closing(&self, u: &[f64], closing: &mut [f64]) {
        match self {
            Trace::Nodes {
                columns,
                start,
                sign,
            } => {
                let value = |[i, j]: [usize; 2]| sign * u[start + j * columns.count[0] + i];
                columns.add_to_plane(closing, value);
            }
            Trace::Means(mortar) => mortar.add_closing(u, closing),
        }
    }

    /// `out` += B^T f for the forces (node, value).
    pub fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]) {
        match self {
            Trace::Nodes {
                columns,
                start,
                sign,
            } => {
                for &(node, force) in forces {
                    if let Some([i, j]) = columns.local(node) {
                        out[start + j * columns.count[0] + i] += sign * force;
                    }
                }
            }
            Trace::Means(mortar) => mortar.add_forces(forces, 1.0, out),
        }
    }
}

// The hexahedra of a body on a tensor grid, for assembly.

/// The body that a tensor operator describes.
///
/// # Errors
/// Those of [`Body::new`].
pub(crate) fn hexahedra(operator: &TensorOperator) -> Result<Body, Error> {
    let [x, y, z] = operator.axes.each_ref().map(|axis| axis.nodes.clone());
    let mesh = TensorGrid { x, y, z }.hex_mesh();
    let of = |material| Section {
        material,
        kind: operator.element_kind(),
    };
    let mut sections = vec![of(operator.material); mesh.cells.len()];
    if let Some(layer) = operator.lower_layer() {
        let [nx, ny, _] = operator.shape().map(|nodes| nodes - 1);
        sections[..nx * ny * layer.cells].fill(of(layer.material));
    }
    Body::new(mesh, sections)
}
