//! Coefficients by least squares, with errors that hold whatever the correlation in time within a twentieth of a run.

use nalgebra::{DMatrix, DVector};

/// A coefficient and its standard error.
pub type Coefficient = (f64, f64);

/// Coefficients of columns and a constant, with errors by leaving out a twentieth at a time; `rows` are places in the columns
/// and values. `None` where the columns do not determine them.
pub fn coefficients(columns: &[&[f64]], rows: &[(usize, f64)]) -> Option<Vec<Coefficient>> {
    const BLOCKS: usize = 20;
    let width = columns.len() + 1;
    let scale: Vec<f64> = columns
        .iter()
        .map(|x| {
            x.iter()
                .fold(0.0_f64, |most, y| most.max(y.abs()))
                .max(1e-300)
        })
        .collect();
    let empty = (DMatrix::zeros(width, width), DVector::zeros(width));
    let mut blocks = vec![empty.clone(); BLOCKS];
    for (k, (i, y)) in rows.iter().enumerate() {
        let own = columns.iter().zip(&scale).map(|(x, scale)| x[*i] / scale);
        let x = DVector::from_iterator(width, own.chain([1.0]));
        let block = &mut blocks[k * BLOCKS / rows.len()];
        block.0 += &x * x.transpose();
        block.1 += &x * *y;
    }
    let sum = blocks.iter().fold(empty, |(a, b), (c, d)| (a + c, b + d));
    let solve = |a: DMatrix<f64>, b: DVector<f64>| a.cholesky().map(|factor| factor.solve(&b));
    let all = solve(sum.0.clone(), sum.1.clone())?;
    let without: Vec<DVector<f64>> = blocks
        .iter()
        .map(|(a, b)| solve(&sum.0 - a, &sum.1 - b))
        .collect::<Option<_>>()?;
    let share = (BLOCKS - 1) as f64 / BLOCKS as f64;
    let mean = |k: usize| without.iter().map(|b| b[k]).sum::<f64>() / BLOCKS as f64;
    let error = |k: usize| {
        let squares: f64 = without.iter().map(|b| (b[k] - mean(k)).powi(2)).sum();
        (share * squares).sqrt()
    };
    let found = (0..columns.len()).map(|k| (all[k] / scale[k], error(k) / scale[k]));
    Some(found.collect())
}
