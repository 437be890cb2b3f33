//! Eigenpairs of symmetric matrices in an order of operations that does not depend on the number of threads.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, Par};

/// Eigenvalues of the symmetric matrix `a`, increasing, and their eigenvectors, one a column; `None` where they do not converge.
///
/// On one thread: with more of them faer sums the halves of a product apart, which moves the last digits.
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
