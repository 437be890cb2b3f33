//! Inverses of normal matrices that may be singular.

use nalgebra::DMatrix;

/// The inverse of a symmetric non-negative matrix, without its null directions.
pub fn ridge_inverse(mut matrix: DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let scale: Vec<f64> = (0..n)
        .map(|i| {
            if matrix[(i, i)] > 0.0 {
                1.0 / matrix[(i, i)].sqrt()
            } else {
                0.0
            }
        })
        .collect();
    for i in 0..n {
        for j in 0..n {
            matrix[(i, j)] *= scale[i] * scale[j];
        }
    }
    let eigen = matrix.symmetric_eigen();
    let mut inverse = DMatrix::zeros(n, n);
    for (k, value) in eigen.eigenvalues.iter().enumerate() {
        if *value > 1e-10 {
            let vector = eigen.eigenvectors.column(k);
            inverse += vector * vector.transpose() / *value;
        }
    }
    for i in 0..n {
        for j in 0..n {
            inverse[(i, j)] *= scale[i] * scale[j];
        }
    }
    inverse
}
