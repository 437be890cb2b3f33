//! Inverses of normal matrices that may be singular.

use nalgebra::DMatrix;

/// The inverse of a symmetric non-negative matrix, without its null directions.
pub fn ridge_inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let root = |x: f64| if x > 0.0 { 1.0 / x.sqrt() } else { 0.0 };
    let scale = matrix.diagonal().map(root);
    let scales = &scale * scale.transpose();
    let eigen = matrix.component_mul(&scales).symmetric_eigen();
    let mut inverse = DMatrix::zeros(matrix.nrows(), matrix.nrows());
    for (k, value) in eigen.eigenvalues.iter().enumerate() {
        if *value > 1e-10 {
            let vector = eigen.eigenvectors.column(k);
            inverse += vector * vector.transpose() / *value;
        }
    }
    inverse.component_mul(&scales)
}
