//! Result types of a search ([`kufe::results::finding`]), and the selection of bins in them.

pub use kufe::results::finding::*;

/// Largest p-value of a bin that is reported.
pub(crate) const BIN_SHOWN: f64 = 0.05;
/// Most bins that are reported.
pub(crate) const BINS_SHOWN: usize = 40;

/// Bins that are significant among all of them (Bonferroni), strongest first.
pub(crate) fn significant(mut bins: Vec<Bin>) -> Vec<Bin> {
    let count = bins.len() as f64;
    for bin in &mut bins {
        bin.p_value = (bin.p_value * count).min(1.0);
    }
    bins.retain(|bin| bin.p_value <= BIN_SHOWN);
    bins.sort_by(|a, b| {
        let t = |bin: &Bin| (bin.mean / bin.error.max(1e-300)).abs();
        t(b).total_cmp(&t(a))
    });
    bins.truncate(BINS_SHOWN);
    bins
}
