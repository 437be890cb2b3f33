//! One elastic body of a contact: stiffness, preconditioner, and the plane with which it touches.

use std::sync::Mutex;

use kufe_fem::{Body as Solid, End, LayeredDiagonal, Material, MatrixFree, TensorOperator};

use crate::surface::SurfaceModes;

/// A rectangle of columns of the contact plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Columns {
    /// First column along x and along y.
    pub first: [usize; 2],
    /// Number of columns along x and along y.
    pub count: [usize; 2],
}

impl Columns {
    /// The plane node (i, j) in this rectangle's own numbering, x fastest.
    pub fn local(&self, [i, j]: [usize; 2]) -> Option<usize> {
        let (i, j) = (i.checked_sub(self.first[0])?, j.checked_sub(self.first[1])?);
        (i < self.count[0] && j < self.count[1]).then_some(j * self.count[0] + i)
    }
}

/// Which way the gap moves with a body's vertical displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The body below, the ice: rising closes the gap.
    Below,
    /// The body above, the runner: rising opens it.
    Above,
}

/// One elastic body, its preconditioner, and the plane with which it touches.
pub(crate) struct Body {
    /// Tensor grid of the body itself, or the box that a mapped body is preconditioned by.
    pub operator: TensorOperator,
    /// The stiffness on mapped hexahedra, where the body is none of tensor shape.
    mapped: Option<Mutex<Mapped>>,
    /// P, spectrally equivalent to the stiffness.
    pub preconditioner: LayeredDiagonal,
    /// Surface response of P.
    pub modes: SurfaceModes,
    /// Index of the contact plane along z.
    plane: usize,
    /// Columns of the contact plane that the body stands on.
    pub columns: Columns,
    /// +1 below, -1 above: the gap shrinks by sign times the vertical displacement.
    pub sign: f64,
    /// Factor by which the true surface response exceeds that of P on a half-space.
    pub response: f64,
    /// Young's modulus and Poisson's ratio.
    pub material: Material,
}

/// A matrix-free stiffness and vectors in its order, node by node.
struct Mapped {
    stiffness: MatrixFree,
    displacement: Vec<f64>,
    force: Vec<f64>,
}

impl Body {
    /// Sets up the preconditioner and the surface response of a body.
    ///
    /// On a half-space both responses are 1 / |k| in the wave number: (1 - nu) / mu for elasticity,
    /// 1 / sqrt(mu (lambda + 2 mu)) for P; `response` is their ratio.
    pub fn new(operator: TensorOperator, material: Material, side: Side, columns: Columns) -> Self {
        let [_, _, nz] = operator.shape();
        let (plane, end, sign) = match side {
            Side::Below => (nz - 1, End::High, 1.0),
            Side::Above => (0, End::Low, -1.0),
        };
        let preconditioner = LayeredDiagonal::new(&operator, end);
        let modes = SurfaceModes::new(&preconditioner);
        let stiffness_ratio = (operator.lambda + 2.0 * operator.mu) / operator.mu;
        let response = (1.0 - material.poissons_ratio()) * stiffness_ratio.sqrt();
        Body {
            operator,
            mapped: None,
            preconditioner,
            modes,
            plane,
            columns,
            sign,
            response,
            material,
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

    /// Length of a displacement vector.
    pub fn len(&self) -> usize {
        3 * self.operator.node_count()
    }

    /// Where the vertical displacements of the contact plane begin in this body's vector.
    pub fn plane_start(&self) -> usize {
        let [nx, ny, nz] = self.operator.shape();
        (2 * nz + self.plane) * nx * ny
    }

    /// `out` = K `u`, with 0 on held entries.
    pub fn apply(&self, u: &[f64], out: &mut [f64]) {
        let Some(mapped) = &self.mapped else {
            return self.operator.apply(u, out);
        };
        // The lock is never contended: one iteration runs at a time.
        let mut mapped = mapped
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let Mapped {
            stiffness,
            displacement,
            force,
        } = &mut *mapped;
        let nodes = u.len() / 3;
        for (node, values) in displacement.chunks_exact_mut(3).enumerate() {
            values.copy_from_slice(&[u[node], u[nodes + node], u[2 * nodes + node]]);
        }
        stiffness.apply(displacement, force);
        for (node, values) in force.chunks_exact(3).enumerate() {
            for c in 0..3 {
                out[c * nodes + node] = values[c];
            }
        }
        self.operator.mask(out);
    }
}
