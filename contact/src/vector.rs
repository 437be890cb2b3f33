//! Long vectors: sums in a fixed order, so that results do not depend on the number of threads.

use rayon::prelude::*;

/// Numbers that one task handles.
pub(crate) const CHUNK: usize = 16384;

/// Scalar product, summed chunk by chunk in order.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(|(a, b)| chunk_dot(a, b))
        .collect();
    parts.iter().sum()
}

/// Eight running sums, so that the loop fills vector registers.
fn chunk_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_blocks, b_blocks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_blocks
        .remainder()
        .iter()
        .zip(b_blocks.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a_blocks.zip(b_blocks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// `a` += `factor` `b`.
pub(crate) fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .for_each(|(a, b)| a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b));
}

/// `a` = `factor` `a` + `b`.
pub(crate) fn scale_add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .for_each(|(a, b)| a.iter_mut().zip(b).for_each(|(a, b)| *a = factor * *a + b));
}
