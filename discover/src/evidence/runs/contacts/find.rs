//! Places of a track at which runs differ, by their lateral residuals.
//!
//! Errors of survey and model are common to all runs, contacts are not: the median over the runs of
//! a track is subtracted first. With d the remaining lateral residual in cells of two metres, and
//! sums Z over ten metres, a run differs where
//!
//! ```text
//! |Z| > 8 (1.4826 median |Z|)        8: ContactRules::differs
//! ```
//!
//! A place is also found if no run is significant alone but the mean square over the runs exceeds
//! that of other places.

use std::collections::BTreeSet;
use std::ops::Range;

use kufe_sled::scatter;
use rayon::prelude::*;

use crate::evidence::runs::recordings::frame::Frame;
use crate::null::random::{below, stream};
use crate::procedure::rules::ContactRules;

/// Length of a cell \[m\].
const CELL_M: f64 = 2.0;
/// Number of cells of a sum.
const SUM: usize = 5;
/// Clipping of a single run's deviation, in units of the scatter, so that one run alone is not
/// significant. Chosen.
const MAX_DEVIATION: f64 = 6.0;
/// Random shifts of all runs for the null distribution.
const TRIALS: u64 = 3999;
/// Smallest number of runs of a track: the median of three runs is the value of one of them.
const MIN_RUNS: usize = 4;
/// Largest number of cells of a track: a distance above 100 km is a mistake.
const MAX_CELLS: usize = 50_000;

/// An interval of a track \[m\] on which some runs differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    pub track: String,
    /// Start \[m\].
    pub from_m: f64,
    /// End \[m\].
    pub to_m: f64,
    /// p-value against the same runs, each shifted along the track; 1 if not requested.
    pub p_value: f64,
}

/// The intervals of all tracks at which runs differ. `side_n` is the lateral residual of each run
/// at every retained sample; without a `seed` no p-values are computed.
pub fn stretches(
    frames: &[Frame],
    side_n: &[Vec<f64>],
    rules: &ContactRules,
    seed: Option<u64>,
) -> Vec<Stretch> {
    let tracks: BTreeSet<&str> = frames.iter().map(|f| f.track.as_str()).collect();
    let on = |track: &str| -> Vec<(&Frame, &[f64])> {
        let both = frames.iter().zip(side_n);
        both.filter(|(f, _)| f.track == track)
            .map(|(f, y)| (f, y.as_slice()))
            .collect()
    };
    tracks
        .into_iter()
        .flat_map(|track| on_track(track, &on(track), rules, seed))
        .collect()
}

fn on_track(
    track: &str,
    runs: &[(&Frame, &[f64])],
    rules: &ContactRules,
    seed: Option<u64>,
) -> Vec<Stretch> {
    let places = || runs.iter().flat_map(|(f, _)| &f.s).copied();
    let low = places().fold(f64::INFINITY, f64::min);
    let high = places().fold(f64::NEG_INFINITY, f64::max);
    let cells = ((high - low) / CELL_M).ceil();
    // Also excludes NaN.
    let cells = cells as usize;
    if runs.len() < MIN_RUNS || !(SUM + 1..=MAX_CELLS).contains(&cells) {
        return Vec::new();
    }
    let of_runs = runs.iter().map(|(frame, y)| means(frame, y, low, cells));
    let mut rows: Vec<Vec<f64>> = of_runs.collect();
    subtract_median(&mut rows, cells);
    let sums: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| row.windows(SUM).map(|w| w.iter().sum()).collect())
        .collect();
    let unit = scatter(&sums.concat());
    if unit <= 0.0 {
        return Vec::new();
    }
    let squares = squares(&sums, unit);
    let roots = joint_differences(&squares);
    let away = deviations_from_median(&roots);
    let together = exceeding(&away, rules.together, 0.7 * rules.together);
    let alone = sums.iter().flat_map(|row| {
        let sizes: Vec<f64> = row.iter().map(|z| z.abs()).collect();
        exceeding(&sizes, rules.differs * unit, rules.ends * unit)
    });
    let mut differs = vec![false; cells];
    for sums in alone.chain(together) {
        // The cells in the middle of a sum.
        differs[sums.start + 1..(sums.end + SUM - 2).min(cells)].fill(true);
    }
    let all = || sums.iter().flatten().filter(|z| z.is_finite());
    let exceeding = all().filter(|z| z.abs() > rules.differs * unit).count();
    if exceeding as f64 > rules.most * all().count() as f64 {
        return Vec::new();
    }
    let seed = seed.filter(|_| differs.contains(&true));
    let chance = seed.map_or(Vec::new(), |seed| null_distribution(&squares, seed));
    let count = roots.len();
    let mut found = Vec::new();
    let mut start = 0;
    for group in differs.chunk_by(|a, b| a == b) {
        let end = start + group.len();
        if group[0] {
            // Sums that start at a cell of the interval.
            let most = roots[start.min(count - 1)..end.min(count)]
                .iter()
                .copied()
                .fold(0.0, f64::max);
            found.push(Stretch {
                p_value: (1 + chance.len() - chance.partition_point(|u| *u < most)) as f64
                    / (1 + chance.len()) as f64,
                track: track.to_owned(),
                from_m: low + start as f64 * CELL_M - CELL_M,
                to_m: low + end as f64 * CELL_M + CELL_M,
            });
        }
        start = end;
    }
    found
}

/// Subtracts the median over the runs from each cell.
fn subtract_median(rows: &mut [Vec<f64>], cells: usize) {
    for cell in 0..cells {
        let values = rows.iter().map(|row| row[cell]);
        let mut here: Vec<f64> = values.filter(|x| x.is_finite()).collect();
        here.sort_by(f64::total_cmp);
        let middle = match here.len() {
            0 => f64::NAN,
            n => 0.5 * (here[(n - 1) / 2] + here[n / 2]),
        };
        rows.iter_mut().for_each(|row| row[cell] -= middle);
    }
}

/// Squares of sums in units of their scatter, clipped at six deviations.
fn squares(sums: &[Vec<f64>], unit: f64) -> Vec<Vec<f64>> {
    let square = |z: &f64| {
        if z.is_finite() {
            (z / unit).abs().min(MAX_DEVIATION).powi(2)
        } else {
            f64::NAN
        }
    };
    let of_run = |row: &Vec<f64>| row.iter().map(square).collect();
    sums.iter().map(of_run).collect()
}

/// Difference of runs at each sum: `q^(1/3)`, with q the mean square over the runs without the
/// largest square, which may be an outlier. The cube root is nearly normal. NaN where few runs have
/// samples.
///
/// Source: E. B. Wilson and M. M. Hilferty, The distribution of chi-square, Proc. Natl. Acad. Sci.
/// 17 (1931) 684.
fn joint_differences(squares: &[Vec<f64>]) -> Vec<f64> {
    let unmoved = vec![0; squares.len()];
    let root = |w: usize| mean_of_others(squares, &unmoved, w).cbrt();
    (0..squares[0].len()).map(root).collect()
}

/// Mean of the squares at a sum without the largest, with shifted runs; NaN if few runs remain.
fn mean_of_others(squares: &[Vec<f64>], shifts: &[usize], w: usize) -> f64 {
    let (mut n, mut sum, mut most) = (0.0, 0.0, 0.0_f64);
    for (row, by) in squares.iter().zip(shifts) {
        let at = w + by;
        let q = row[if at < row.len() { at } else { at - row.len() }];
        if !q.is_nan() {
            (n, sum, most) = (n + 1.0, sum + q, most.max(q));
        }
    }
    if 2.0 * n > squares.len() as f64 && n > 1.0 {
        (sum - most) / (n - 1.0)
    } else {
        f64::NAN
    }
}

/// Deviations from the median, in units of a robust standard deviation.
fn deviations_from_median(roots: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = roots.iter().copied().filter(|u| u.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN);
    let away: Vec<f64> = roots.iter().map(|u| u - middle).collect();
    let deviation = scatter(&away);
    away.iter().map(|away| away / deviation).collect()
}

/// Null distribution of the largest value of [`joint_differences`], sorted: every run is shifted
/// cyclically along the track on its own.
fn null_distribution(squares: &[Vec<f64>], seed: u64) -> Vec<f64> {
    let count = squares[0].len();
    let largest = |trial: u64| {
        let mut rng = stream(seed, 0x5717F7, trial);
        let shifts: Vec<usize> = squares.iter().map(|_| below(&mut rng, count)).collect();
        let means = (0..count).map(|w| mean_of_others(squares, &shifts, w));
        means.fold(f64::NEG_INFINITY, f64::max).cbrt()
    };
    let mut largest: Vec<f64> = (0..TRIALS).into_par_iter().map(largest).collect();
    largest.sort_by(f64::total_cmp);
    largest
}

/// Intervals of values of which one exceeds `threshold`, each as long as they exceed `end`.
fn exceeding(values: &[f64], threshold: f64, end: f64) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for group in values.chunk_by(|a, b| (*a > end) == (*b > end)) {
        let next = start + group.len();
        if group.iter().any(|value| *value > threshold) {
            found.push(start..next);
        }
        start = next;
    }
    found
}

/// Means over cells; NaN for cells without a sample.
fn means(frame: &Frame, y: &[f64], low: f64, cells: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); cells];
    for i in frame.samples() {
        let cell = (((frame.s[i] - low) / CELL_M) as usize).min(cells - 1);
        sums[cell] = (sums[cell].0 + y[i], sums[cell].1 + 1.0);
    }
    let mut means: Vec<f64> = sums.iter().map(|(sum, n)| sum / n).collect();
    // A fast sled may have no sample in a cell.
    for cell in 1..cells {
        if means[cell].is_nan() && sums[cell - 1].1 > 0.0 {
            means[cell] = means[cell - 1];
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};

    /// Noise of ten runs, with random sums of two deviations within `pushed`.
    fn sums(draw: u64, pushed: std::ops::Range<usize>) -> Vec<Vec<f64>> {
        let mut rng = stream(3, 0x3A11, draw);
        let row = |_| {
            let push = 2.0 * normal(&mut rng).signum();
            let noise = (0..200).map(|_| normal(&mut rng)).collect::<Vec<f64>>();
            let pushed = |w: usize| if pushed.contains(&w) { push } else { 0.0 };
            (0..200).map(|w| noise[w] + pushed(w)).collect()
        };
        (0..10).map(row).collect()
    }

    #[test]
    fn places_are_found_by_all_runs_together_and_noise_has_none() {
        let rules = ContactRules::default();
        let roots = |sums: &[Vec<f64>]| joint_differences(&squares(sums, 1.0));
        let chance = |draw: u64, pushed: std::ops::Range<usize>| {
            let sums = sums(draw, pushed);
            let most = roots(&sums).into_iter().fold(f64::NEG_INFINITY, f64::max);
            let by_chance = null_distribution(&squares(&sums, 1.0), 1);
            by_chance.iter().filter(|u| **u >= most).count() as f64 / by_chance.len() as f64
        };
        let by_chance = (0..40).filter(|draw| chance(*draw, 0..0) < 0.05);
        assert!(by_chance.count() <= 5, "the stated rate of false positives");
        let hit = (0..200).filter(|draw| {
            let away = deviations_from_median(&roots(&sums(*draw, 100..105)));
            let there = exceeding(&away, rules.together, 0.7 * rules.together);
            there.iter().any(|sums| sums.start >= 99 && sums.end <= 106)
        });
        let hit = hit.count();
        assert!(hit >= 150, "{hit} of 200");
        let detected = (0..20).filter(|draw| chance(*draw, 100..105) < 0.01);
        assert!(detected.count() >= 15);
    }
}
