//! Dense matrices in slices; their products and eigenvectors on one thread.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::traits::math_utils::one;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// The beginning of `data` as a matrix of so many rows and columns, column by column.
pub(crate) fn columns<T>(data: &[T], [rows, cols]: [usize; 2]) -> MatRef<'_, T> {
    MatRef::from_column_major_slice(&data[..rows * cols], rows, cols)
}

/// The same to be written to.
pub(crate) fn columns_mut<T>(data: &mut [T], [rows, cols]: [usize; 2]) -> MatMut<'_, T> {
    MatMut::from_column_major_slice_mut(&mut data[..rows * cols], rows, cols)
}

/// `to` = `left` `right`.
pub(crate) fn product<T: ComplexField>(
    to: MatMut<'_, T>,
    left: MatRef<'_, T>,
    right: MatRef<'_, T>,
) {
    matmul(to, Accum::Replace, left, right, one(), Par::Seq);
}

/// Eigenvalues, increasing, and orthonormal eigenvectors, a column each, of a symmetric matrix of which the lower half is read; `None`
/// where they do not converge. The order of operations does not depend on the number of threads.
pub(crate) fn self_adjoint_eigen(a: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = a.nrows();
    let mut values = Diag::zeros(n);
    let mut vectors = Mat::zeros(n, n);
    let request =
        self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(request);
    self_adjoint_evd(
        a.as_ref(),
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .ok()?;
    Some((values.column_vector().iter().copied().collect(), vectors))
}
