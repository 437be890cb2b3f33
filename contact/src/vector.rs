//! Long vectors: sums in a fixed order, so that results do not depend on the number of threads.

use rayon::prelude::*;

/// Number of entries that one task handles.
pub(crate) const CHUNK: usize = 16384;

/// Scalar product, summed chunk by chunk in order.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(|(a, b)| {
            // Compiled for the widest vector unit of this machine, here and below.
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || chunk_dot(a, b),
            )
        })
        .collect();
    parts.iter().sum()
}

/// Sixteen running sums, so that the loop fills vector registers.
#[inline(always)]
fn chunk_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<16>(), b.as_chunks::<16>());
    for (a, b) in a.iter().zip(b) {
        for k in 0..16 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// `a` += `b`.
pub(crate) fn add(a: &mut [f64], b: &[f64]) {
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .for_each(|(a, b)| {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || a.iter_mut().zip(b).for_each(|(a, b)| *a += b),
            );
        });
}

/// `a` += `factor` `b` and `c` -= `factor` `d`.
pub(crate) fn add_two(factor: f64, [a, c]: [&mut [f64]; 2], [b, d]: [&[f64]; 2]) {
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .zip(c.par_chunks_mut(CHUNK))
        .zip(d.par_chunks(CHUNK))
        .for_each(|(((a, b), c), d)| {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
                    c.iter_mut().zip(d).for_each(|(c, d)| *c -= factor * d);
                },
            );
        });
}

/// `a` = `factor` `a` + `b`.
pub(crate) fn scale_add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .for_each(|(a, b)| {
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || a.iter_mut().zip(b).for_each(|(a, b)| *a = factor * *a + b),
            );
        });
}
