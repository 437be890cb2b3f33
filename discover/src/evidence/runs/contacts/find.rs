//! Places of a track at which runs differ: where the side balance of some runs leaves the middle of all.
//!
//! What all runs do alike, errors of survey and model, is no contact: the median over the runs of a track is taken off first. With d what
//! is left of the side balance in cells of two metres, and sums Z over ten metres, a run differs where
//!
//! ```text
//! |Z| > 8 (1.4826 median |Z|)        8 and the other constants: ContactRules
//! ```
//!
//! and so do runs of which none stands out alone but whose squares together exceed those of other places.

use kufe_sled::scatter;

use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::rules::ContactRules;

/// Length of a cell \[m\].
const CELL_M: f64 = 2.0;
/// Cells of a sum.
const SUM: usize = 5;
/// Most cells of a track: beyond 100 km a distance is a mistake.
const MOST_CELLS: usize = 50_000;

/// A stretch of a track \[m\] on which some runs differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Track.
    pub track: String,
    /// From and to \[m\].
    pub from_m: f64,
    /// To \[m\].
    pub to_m: f64,
}

/// The stretches of all tracks, `side_n` being what the side balance leaves of each run at every kept sample.
pub fn stretches(frames: &[Frame], side_n: &[Vec<f64>], rules: &ContactRules) -> Vec<Stretch> {
    let mut tracks: Vec<&str> = frames.iter().map(|f| f.track.as_str()).collect();
    tracks.sort_unstable();
    tracks.dedup();
    let on = |track: &str| -> Vec<(&Frame, &[f64])> {
        let both = frames.iter().zip(side_n);
        both.filter(|(f, _)| f.track == track)
            .map(|(f, y)| (f, y.as_slice()))
            .collect()
    };
    tracks
        .into_iter()
        .flat_map(|track| on_track(track, &on(track), rules))
        .collect()
}

fn on_track(track: &str, runs: &[(&Frame, &[f64])], rules: &ContactRules) -> Vec<Stretch> {
    let places = || runs.iter().flat_map(|(f, _)| &f.s).copied();
    let low = places().fold(f64::INFINITY, f64::min);
    let high = places().fold(f64::NEG_INFINITY, f64::max);
    let cells = ((high - low) / CELL_M).ceil();
    // Of no number there are no cells.
    let cells = cells as usize;
    if runs.len() < rules.fewest_runs || !(SUM + 1..=MOST_CELLS).contains(&cells) {
        return Vec::new();
    }
    let mut rows: Vec<Vec<f64>> = runs
        .iter()
        .map(|(frame, y)| means(frame, y, low, cells))
        .collect();
    for cell in 0..cells {
        let mut here: Vec<f64> = rows
            .iter()
            .map(|r| r[cell])
            .filter(|x| x.is_finite())
            .collect();
        here.sort_by(f64::total_cmp);
        let middle = match here.len() {
            0 => f64::NAN,
            n => 0.5 * (here[(n - 1) / 2] + here[n / 2]),
        };
        rows.iter_mut().for_each(|row| row[cell] -= middle);
    }
    let sums: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| row.windows(SUM).map(|w| w.iter().sum()).collect())
        .collect();
    let unit = scatter(&sums.concat());
    if unit <= 0.0 {
        return Vec::new();
    }
    let mut differs = vec![false; cells];
    let within = |z: &f64| z.abs() > rules.ends * unit;
    for row in &sums {
        let mut start = 0;
        for group in row.chunk_by(|a, b| within(a) == within(b)) {
            let end = start + group.len();
            if group.iter().any(|z| z.abs() > rules.differs * unit) {
                // A sum stands for its middle cells.
                differs[start + 1..(end + SUM - 2).min(cells)].fill(true);
            }
            start = end;
        }
    }
    for (start, end) in together(&sums, unit, rules.together) {
        differs[start + 1..(end + SUM - 2).min(cells)].fill(true);
    }
    let all = || sums.iter().flatten().filter(|z| z.is_finite());
    let beyond = all().filter(|z| z.abs() > rules.differs * unit).count();
    if beyond as f64 > rules.most * all().count() as f64 {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut start = 0;
    for group in differs.chunk_by(|a, b| a == b) {
        let end = start + group.len();
        if group[0] {
            found.push(Stretch {
                track: track.to_owned(),
                from_m: low + start as f64 * CELL_M - CELL_M,
                to_m: low + end as f64 * CELL_M + CELL_M,
            });
        }
        start = end;
    }
    found
}

/// Stretches of sums on which all runs together scatter more than elsewhere: with n runs, q the mean of their squares and
/// `u = q^(1/3)`, which is nearly normal, where u leaves its median by `beyond` robust deviations.
///
/// Source: E. B. Wilson and M. M. Hilferty, The distribution of chi-square, Proc. Natl. Acad. Sci. 17 (1931) 684.
fn together(sums: &[Vec<f64>], unit: f64, beyond: f64) -> Vec<(usize, usize)> {
    let count = sums[0].len();
    let roots: Vec<f64> = (0..count)
        .map(|w| {
            let here = sums.iter().map(|row| row[w]).filter(|z| z.is_finite());
            let (n, squares) = here.fold((0.0, 0.0), |(n, q), z| (n + 1.0, q + (z / unit).powi(2)));
            // Where few runs came there is no telling.
            if 2.0 * n > sums.len() as f64 {
                f64::cbrt(squares / n)
            } else {
                f64::NAN
            }
        })
        .collect();
    let mut sorted: Vec<f64> = roots.iter().copied().filter(|u| u.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let Some(middle) = sorted.get(sorted.len() / 2).copied() else {
        return Vec::new();
    };
    let away: Vec<f64> = roots.iter().map(|u| u - middle).collect();
    let deviation = scatter(&away);
    let mut found = Vec::new();
    let mut start = 0;
    for group in
        away.chunk_by(|a, b| (*a > 0.5 * beyond * deviation) == (*b > 0.5 * beyond * deviation))
    {
        let end = start + group.len();
        let most = group.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most > beyond * deviation {
            found.push((start, end));
        }
        start = end;
    }
    found
}

/// Means over cells; NaN where no sample takes part.
fn means(frame: &Frame, y: &[f64], low: f64, cells: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); cells];
    for i in frame.samples() {
        let cell = (((frame.s[i] - low) / CELL_M) as usize).min(cells - 1);
        sums[cell] = (sums[cell].0 + y[i], sums[cell].1 + 1.0);
    }
    let mut means: Vec<f64> = sums.iter().map(|(sum, n)| sum / n).collect();
    // A fast sled may leave a cell without a sample.
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

    /// Sums of noise of ten runs, those at `pushed` with pushes of two deviations to either side.
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
    fn places_at_which_no_run_stands_out_alone_are_found_by_all_and_noise_is_none() {
        let rules = ContactRules::default();
        let found = |sums: &[Vec<f64>]| together(sums, 1.0, rules.together);
        let noise = (0..200).filter(|draw| !found(&sums(*draw, 0..0)).is_empty());
        assert!(noise.count() <= 2, "one in a hundred");
        let hit = (0..200).filter(|draw| {
            let there = found(&sums(*draw, 100..105));
            there.iter().any(|(from, to)| *from >= 99 && *to <= 106)
        });
        let hit = hit.count();
        assert!(hit >= 150, "{hit} of 200");
    }
}
