//! One axis of a tensor grid: the 1-D matrices of linear elements and their eigenvectors.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};

/// A tridiagonal matrix by rows: `(below, on, above)` the diagonal.
///
/// The first row's `below` and the last row's `above` are 0.
pub type Tridiagonal = Vec<[f64; 3]>;

/// The 1-D matrices of linear elements on graded nodes.
///
/// With hat functions phi_i on the nodes: stiffness K_ij = int phi_i' phi_j', mass
/// M_ij = int phi_i phi_j, gradient D_ij = int phi_i' phi_j (which does not depend on the spacing),
/// and the lumped mass m_i = int phi_i.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Node coordinates, strictly increasing [m].
    pub nodes: Vec<f64>,
    /// K, [1/m].
    pub stiffness: Tridiagonal,
    /// M, [m].
    pub mass: Tridiagonal,
    /// D, dimensionless.
    pub gradient: Tridiagonal,
    /// Row sums of M, [m].
    pub lumped_mass: Vec<f64>,
}

impl Axis {
    /// Assembles the matrices.
    ///
    /// # Panics
    /// If there are fewer than two nodes or they do not increase: grids are not user input.
    pub fn new(nodes: &[f64]) -> Self {
        Axis::weighted(nodes, |_| [1.0; 2])
    }

    /// Assembles the matrices with factors per element: `weights(e)` are those of K and of M (and
    /// of the lumped mass).
    ///
    /// # Panics
    /// As [`Axis::new`].
    pub fn weighted(nodes: &[f64], weights: impl Fn(usize) -> [f64; 2]) -> Self {
        let n = nodes.len();
        assert!(
            n >= 2 && nodes.windows(2).all(|w| w[1] > w[0]),
            "axis nodes must increase: {n} nodes"
        );
        let mut axis = Axis {
            nodes: nodes.to_vec(),
            stiffness: vec![[0.0; 3]; n],
            mass: vec![[0.0; 3]; n],
            gradient: vec![[0.0; 3]; n],
            lumped_mass: vec![0.0; n],
        };
        for e in 0..n - 1 {
            let [of_stiffness, of_mass] = weights(e);
            let k = of_stiffness / (nodes[e + 1] - nodes[e]);
            let h = of_mass * (nodes[e + 1] - nodes[e]);
            add_element(&mut axis.stiffness, e, [[k, -k], [-k, k]]);
            add_element(&mut axis.mass, e, [[h / 3.0, h / 6.0], [h / 6.0, h / 3.0]]);
            add_element(&mut axis.gradient, e, [[-0.5, -0.5], [0.5, 0.5]]);
            axis.lumped_mass[e] += h / 2.0;
            axis.lumped_mass[e + 1] += h / 2.0;
        }
        axis
    }

    /// This axis with the mass of cellwise averages, sum over cells of h (u_i + u_(i+1)) (v_i +
    /// v_(i+1)) / 4, and `share` of the consistent mass in excess of it.
    ///
    /// Averages are zero for values that alternate from node to node; a small positive share keeps
    /// M definite.
    pub fn averaged(&self, share: f64) -> Self {
        let mut axis = self.clone();
        axis.mass = vec![[0.0; 3]; self.len()];
        for (e, w) in self.nodes.windows(2).enumerate() {
            let (mean, rest) = ((w[1] - w[0]) / 4.0, share * (w[1] - w[0]) / 12.0);
            let (on, off) = (mean + rest, mean - rest);
            add_element(&mut axis.mass, e, [[on, off], [off, on]]);
        }
        axis
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Always false: an axis has at least two nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Solves K q = theta M q on the nodes that `fixed` (low end, high end) leaves free.
    pub fn modes(&self, fixed: [bool; 2]) -> AxisModes {
        let n = self.len();
        let first = usize::from(fixed[0]);
        let free = n - first - usize::from(fixed[1]);
        // M is symmetric positive definite: with D = diag(M)^(-1/2) the scaled problem is well
        // conditioned however graded the axis is, and its Cholesky factor is bidiagonal.
        let scale: Vec<f64> = (0..free)
            .map(|i| self.mass[first + i][1].sqrt().recip())
            .collect();
        let mut diagonal = vec![0.0; free];
        let mut below = vec![0.0; free];
        for i in 0..free {
            if i > 0 {
                let off = self.mass[first + i][0] * scale[i] * scale[i - 1];
                below[i] = off / diagonal[i - 1];
            }
            diagonal[i] = (1.0 - below[i] * below[i]).sqrt();
        }
        // A = L^-1 (D K D) L^-T, column by column.
        let scaled = |i: usize, j: usize| -> f64 {
            if i.abs_diff(j) > 1 {
                0.0
            } else {
                self.stiffness[first + i][1 + j - i] * scale[i] * scale[j]
            }
        };
        let mut a = Mat::<f64>::zeros(free, free);
        for j in 0..free {
            let mut previous = 0.0;
            for i in 0..free {
                let value = (scaled(i, j) - below[i] * previous) / diagonal[i];
                a[(i, j)] = value;
                previous = value;
            }
        }
        for i in 0..free {
            let mut previous = 0.0;
            for j in 0..free {
                let value = (a[(i, j)] - below[j] * previous) / diagonal[j];
                a[(i, j)] = value;
                previous = value;
            }
        }
        for j in 0..free {
            for i in 0..j {
                let mean = 0.5 * (a[(i, j)] + a[(j, i)]);
                a[(i, j)] = mean;
                a[(j, i)] = mean;
            }
        }
        let (values, q) = eigenpairs(&a)
            .unwrap_or_else(|| panic!("eigenvalues of a {free} x {free} axis did not converge"));
        let mut vectors = Mat::<f64>::zeros(n, free);
        for m in 0..free {
            let mut next = 0.0;
            for i in (0..free).rev() {
                let coupling = if i + 1 < free {
                    below[i + 1] * next
                } else {
                    0.0
                };
                next = (q[(i, m)] - coupling) / diagonal[i];
                vectors[(first + i, m)] = next * scale[i];
            }
        }
        let values = values.into_iter().map(|value| value.max(0.0)).collect();
        AxisModes { values, vectors }
    }
}

/// Eigenpairs of one axis: K q = theta M q with q^T M q = 1.
#[derive(Clone, Debug)]
pub struct AxisModes {
    /// theta, increasing [1/m2].
    pub values: Vec<f64>,
    /// One column per mode, one row per node; rows of fixed nodes are 0.
    pub vectors: Mat<f64>,
}

fn add_element(matrix: &mut Tridiagonal, e: usize, element: [[f64; 2]; 2]) {
    matrix[e][1] += element[0][0];
    matrix[e][2] += element[0][1];
    matrix[e + 1][0] += element[1][0];
    matrix[e + 1][1] += element[1][1];
}

/// Eigenvalues of the symmetric matrix `a`, increasing, and their eigenvectors as columns; `None`
/// if they do not converge.
///
/// On one thread: with several threads faer sums the halves of a product separately, which changes
/// the last digits.
pub(crate) fn eigenpairs(a: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = a.nrows();
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let yes = ComputeEigenvectors::Yes;
    let request = self_adjoint_evd_scratch::<f64>(n, yes, Par::Seq, Default::default());
    self_adjoint_evd(
        a.as_ref(),
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(request)),
        Default::default(),
    )
    .ok()?;
    let values = values.column_vector().iter().copied().collect();
    Some((values, vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_mass_orthonormal_and_diagonalise_the_stiffness_on_a_graded_axis() {
        let mut nodes = vec![0.0];
        let mut h = 1e-5;
        while nodes.len() < 40 {
            nodes.push(nodes[nodes.len() - 1] + h);
            h *= 1.3;
        }
        let axis = Axis::new(&nodes);
        let modes = axis.modes([false, true]);
        let times = |matrix: &Tridiagonal, m: usize| -> Vec<f64> {
            (0..axis.len())
                .map(|i| {
                    let at = |j: usize| modes.vectors[(j, m)];
                    let mut sum = matrix[i][1] * at(i);
                    if i > 0 {
                        sum += matrix[i][0] * at(i - 1);
                    }
                    if i + 1 < axis.len() {
                        sum += matrix[i][2] * at(i + 1);
                    }
                    sum
                })
                .collect()
        };
        let top = modes.values[modes.values.len() - 1];
        for m in 0..modes.values.len() {
            let (mq, kq) = (times(&axis.mass, m), times(&axis.stiffness, m));
            for l in 0..modes.values.len() {
                let dot = |v: &[f64]| -> f64 {
                    (0..axis.len()).map(|i| modes.vectors[(i, l)] * v[i]).sum()
                };
                let expected = f64::from(u8::from(l == m));
                assert!((dot(&mq) - expected).abs() < 1e-10);
                assert!((dot(&kq) - expected * modes.values[m]).abs() < 1e-12 * top);
            }
        }
    }

    /// On matrices past the size from which faer would work on more than one thread.
    #[test]
    fn eigenpairs_have_the_same_bits_on_any_number_of_threads_and_are_such() {
        for n in [40, 340] {
            let a = Mat::from_fn(n, n, |i, j| (1.0 + i.abs_diff(j) as f64).recip());
            let on = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let pool = pool.build().unwrap();
                pool.install(|| eigenpairs(&a).unwrap())
            };
            let (values, vectors) = on(1);
            for threads in [2, 3] {
                assert!((&values, &vectors) == (&on(threads).0, &on(threads).1));
            }
            let image = &a * &vectors;
            for k in 0..n {
                for i in 0..n {
                    let error = image[(i, k)] - values[k] * vectors[(i, k)];
                    assert!(error.abs() < 1e-12 * values[n - 1], "{i} {k}: {error:e}");
                }
            }
        }
    }
}
