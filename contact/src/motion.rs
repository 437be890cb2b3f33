//! The runner's rigid motion as an unknown of the contact problem.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

/// Approach, pitch and roll: which of them are free, and the balance that determines each free one.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// Whether approach, pitch and roll follow from balance.
    pub free: [bool; 3],
    /// Required N^T f of the free ones: the normal force [N] and the two moments [N m].
    pub balance: [f64; 3],
}

/// The forces f = (G^-1 N) q - G^-1 g, and the motion q for which N^T f is the balance.
///
/// The arguments are those of [`solve_motion`].
pub(crate) fn forces_and_motion(
    motion: &Motion,
    rows: &[[f64; 3]],
    solved: &Mat<f64>,
    balance: [f64; 3],
    current: [f64; 3],
) -> (Vec<f64>, [f64; 3]) {
    let turn = solve_motion(motion, rows, solved, balance, current);
    let force = |i: usize| {
        let moved = (1..4).map(|j| solved[(i, j)] * turn[j - 1]);
        moved.sum::<f64>() - solved[(i, 0)]
    };
    ((0..rows.len()).map(force).collect(), turn)
}

/// The motion q for which N^T f is the balance, with f = (G^-1 N) q - G^-1 g.
///
/// `solved` holds G^-1 g and G^-1 N, one row per node. Motions that do not change the gaps of the
/// contact set (the roll of a single row of nodes) keep their value in `current`.
fn solve_motion(
    motion: &Motion,
    rows: &[[f64; 3]],
    solved: &Mat<f64>,
    balance: [f64; 3],
    current: [f64; 3],
) -> [f64; 3] {
    let mut matrix = Matrix3::zeros();
    let mut side = Vector3::zeros();
    for (a, _) in motion.free.iter().enumerate().filter(|(_, free)| **free) {
        side[a] = balance[a] + dot_rows(rows, a, solved, 0);
        for b in 0..3 {
            let entry = dot_rows(rows, a, solved, b + 1);
            if motion.free[b] {
                matrix[(a, b)] = entry;
            } else {
                side[a] -= entry * current[b];
            }
        }
        for b in (0..3).filter(|&b| motion.free[b]) {
            side[a] -= matrix[(a, b)] * current[b];
        }
    }
    let change = solve_semidefinite(matrix, side);
    [0, 1, 2].map(|a| current[a] + change[a])
}

/// Product of a row N with a motion.
pub(crate) fn dot(row: [f64; 3], motion: [f64; 3]) -> f64 {
    row[0] * motion[0] + row[1] * motion[1] + row[2] * motion[2]
}

/// sum over i of rows[i][a] * solved[i][column].
pub(crate) fn dot_rows(rows: &[[f64; 3]], a: usize, solved: &Mat<f64>, column: usize) -> f64 {
    rows.iter()
        .enumerate()
        .map(|(i, row)| row[a] * solved[(i, column)])
        .sum()
}

/// Solves a symmetric positive semidefinite 3 x 3 system in the least-norm sense, after scaling its
/// diagonal to 1.
pub(crate) fn solve_semidefinite(matrix: Matrix3<f64>, side: Vector3<f64>) -> Vector3<f64> {
    let scale = Vector3::from_fn(|a, _| {
        let d: f64 = matrix[(a, a)];
        if d > 0.0 { d.sqrt().recip() } else { 0.0 }
    });
    let scaled =
        Matrix3::from_fn(|a, b| 0.5 * (matrix[(a, b)] + matrix[(b, a)]) * scale[a] * scale[b]);
    let eigen = scaled.symmetric_eigen();
    let mut out = Vector3::zeros();
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > 1e-10 {
            out += vector * (vector.dot(&side.component_mul(&scale)) / value);
        }
    }
    out.component_mul(&scale)
}
