//! Dense matrices in slices, and their products on one thread.

use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::traits::math_utils::one;
use faer::{Accum, MatMut, MatRef, Par};

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
