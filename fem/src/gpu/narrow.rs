//! Between double and single precision.

use rayon::prelude::*;

use crate::precondition::single_precision::scale_of;

/// Numbers that one task handles.
const CHUNK: usize = 16384;

/// `to` = `scale` `from` in single precision, where `scale`, which is returned, brings the largest to 1 or more and below 2.
pub(super) fn narrow(from: &[f64], to: &mut [f32]) -> f64 {
    let sizes = from.par_chunks(CHUNK).map(|chunk| {
        let sizes = chunk.iter().map(|v| v.abs());
        sizes.fold(0.0, f64::max)
    });
    let scale = scale_of(sizes.reduce(|| 0.0, f64::max));
    to.par_chunks_mut(CHUNK)
        .zip(from.par_chunks(CHUNK))
        .for_each(|(to, from)| {
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to = (scale * from) as f32);
        });
    scale
}

/// `to` += `factor` `from` / `scale`.
///
/// The two factors come one after the other, as their ratio may be beyond the largest number.
pub(super) fn add_widened(to: &mut [f64], factor: f64, from: &[f32], scale: f64) {
    let back = scale.recip();
    to.par_chunks_mut(CHUNK)
        .zip(from.par_chunks(CHUNK))
        .for_each(|(to, from)| {
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to += f64::from(*from) * factor * back);
        });
}
