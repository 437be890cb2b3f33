//! What the kernel of the tensor operator multiplies with.

use crate::tensor_axis::{Axis, Tridiagonal};

/// The 1-D matrices with the Lame constants in them.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    /// M of z.
    pub mass_z: Tridiagonal,
    /// K of z by component, times its coefficient.
    pub stiffness_z: [Tridiagonal; 3],
    /// Halves of mu D^T - lambda D of z for x and y, and of lambda D^T - mu D for z.
    pub gradient_z: [Tridiagonal; 3],
    /// D of z.
    pub plain_gradient_z: Tridiagonal,
    /// M of y.
    pub mass_y: Tridiagonal,
    /// mu K and (lambda + 2 mu) K of y.
    pub stiffness_y: [Tridiagonal; 2],
    /// Diagonals of (lambda + 2 mu) K, mu K and M of x, continued by zeros to whole vectors.
    pub x: [[Vec<f64>; 3]; 3],
    /// Lame constants [Pa].
    pub lambda: f64,
    pub mu: f64,
    /// Nodes along each axis of the whole grid.
    pub shape: [usize; 3],
    /// Plane of the whole grid that the matrices of z begin at.
    pub first: usize,
}

impl Factors {
    /// The same for a part of a grid of `planes` planes, from plane `first` on.
    pub fn within(mut self, first: usize, planes: usize) -> Self {
        (self.first, self.shape[2]) = (first, planes);
        self
    }

    pub fn new([x, y, z]: &[Axis; 3], lambda: f64, mu: f64) -> Self {
        let axial = lambda + 2.0 * mu;
        let gradient = |transposed: f64, plain: f64| -> Tridiagonal {
            let pairs = z.gradient_transposed.iter().zip(&z.gradient);
            pairs
                .map(|(t, d)| std::array::from_fn(|i| 0.5 * (transposed * t[i] + plain * d[i])))
                .collect()
        };
        let diagonals = |matrix: &Tridiagonal| {
            std::array::from_fn(|d| {
                let mut diagonal: Vec<f64> = matrix.iter().map(|row| row[d]).collect();
                diagonal.resize(padded(x.len()), 0.0);
                diagonal
            })
        };
        Factors {
            mass_z: z.mass.clone(),
            stiffness_z: [mu, mu, axial].map(|factor| scaled(&z.stiffness, factor)),
            gradient_z: [
                gradient(mu, -lambda),
                gradient(mu, -lambda),
                gradient(lambda, -mu),
            ],
            plain_gradient_z: z.gradient.clone(),
            mass_y: y.mass.clone(),
            stiffness_y: [mu, axial].map(|factor| scaled(&y.stiffness, factor)),
            x: [
                diagonals(&scaled(&x.stiffness, axial)),
                diagonals(&scaled(&x.stiffness, mu)),
                diagonals(&x.mass),
            ],
            lambda,
            mu,
            shape: [x.len(), y.len(), z.len()],
            first: 0,
        }
    }
}

fn scaled(matrix: &Tridiagonal, factor: f64) -> Tridiagonal {
    matrix.iter().map(|row| row.map(|v| factor * v)).collect()
}

/// Numbers that the widest vector register holds.
pub(crate) const WIDEST: usize = 8;

/// Length of a row of `nx` nodes in whole vectors.
pub(crate) fn padded(nx: usize) -> usize {
    nx.next_multiple_of(WIDEST)
}
