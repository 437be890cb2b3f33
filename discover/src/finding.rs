//! Result types of a search ([`kufe::results::finding`]), and how they are made from residuals.

use statrs::distribution::{ContinuousCDF, StudentsT};

pub use kufe::results::finding::*;

/// Largest p-value of a bin that is reported.
pub(crate) const MAX_BIN_P_VALUE: f64 = 0.05;
/// Largest number of bins that are reported.
pub(crate) const MAX_BINS: usize = 40;

/// A parameter with an interval of this half width.
pub(crate) fn fitted(name: &str, unit: &str, value: f64, half: f64) -> Fitted {
    Fitted {
        name: name.to_owned(),
        value,
        low: value - half,
        high: value + half,
        unit: unit.to_owned(),
    }
}

/// An interval of this half width.
pub(crate) fn symmetric(value: f64, half: f64) -> Interval {
    Interval {
        value,
        low: value - half,
        high: value + half,
    }
}

/// A closed share, from -1 to 1, whose interval excludes no value.
pub(crate) fn undetermined_share(value: f64) -> Interval {
    Interval {
        value,
        low: -1.0,
        high: 1.0,
    }
}

/// The misfit of one channel on held-out data with these names.
pub(crate) fn held_out<'a>(
    what: &str,
    names: impl Iterator<Item = &'a String>,
    misfit: ChannelGap,
) -> HeldOut {
    let runs: Vec<String> = names.cloned().collect();
    HeldOut {
        what: what.to_owned(),
        gap_before: misfit.before,
        gap_after: misfit.after,
        unit: misfit.unit.clone(),
        channels: Vec::from_iter((!runs.is_empty()).then_some(misfit)),
        runs,
    }
}

/// A bin of the values of a column between two ends, with the mean of its residuals.
///
/// `as_one` neighbouring residuals are correlated and count as one value. The p-value is that of
/// Student's t with `freedom` degrees of freedom. `None` if the degrees of freedom are not
/// positive.
pub(crate) fn bin(
    (channel, unit): (&str, &str),
    column: &str,
    [from, to]: [f64; 2],
    residuals: &[f64],
    (as_one, freedom): (f64, f64),
) -> Option<Bin> {
    let n = residuals.len() as f64;
    let mean = residuals.iter().sum::<f64>() / n;
    let variance = residuals.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let error = (variance * as_one / n).sqrt();
    let law = StudentsT::new(0.0, 1.0, freedom).ok()?;
    Some(Bin {
        channel: channel.to_owned(),
        column: column.to_owned(),
        from,
        to,
        mean,
        error,
        unit: unit.to_owned(),
        p_value: 2.0 * law.sf((mean / error.max(1e-300)).abs()),
    })
}

/// Bins that are significant among all of them (Bonferroni), strongest first.
pub(crate) fn significant(mut bins: Vec<Bin>) -> Vec<Bin> {
    let count = bins.len() as f64;
    for bin in &mut bins {
        bin.p_value = (bin.p_value * count).min(1.0);
    }
    bins.retain(|bin| bin.p_value <= MAX_BIN_P_VALUE);
    bins.sort_by(|a, b| {
        let t = |bin: &Bin| (bin.mean / bin.error.max(1e-300)).abs();
        t(b).total_cmp(&t(a))
    });
    bins.truncate(MAX_BINS);
    bins
}
