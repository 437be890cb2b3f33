//! Standard deviation of the residuals by place, relative to the median place.
//!
//! Brakes, a gate or a rough stretch cause scatter at the same places in most runs. With q_b the
//! median over the runs of the mean square of a balance's residuals in the bin b, n_b its rows and
//! q the median of all q_b, residuals are divided by
//!
//! ```text
//! sqrt((4 + n_b q_b / q) / (4 + n_b))
//! ```
//!
//! the expected scale of normal errors whose variance has a scaled inverse chi-squared distribution
//! of 4 degrees of freedom, that is, of Student-t errors. The median over the runs is insensitive
//! to events in single runs.
//!
//! Source: K. L. Lange, R. J. A. Little, J. M. G. Taylor, Robust statistical modeling using the t
//! distribution, Journal of the American Statistical Association 84 (1989) 881.

use std::collections::BTreeMap;

use kufe_sled::median;

use crate::evidence::runs::recordings::frame::{Frame, bin_of};

/// Number of force balances.
const BALANCES: usize = 3;
/// Degrees of freedom of the errors' distribution.
const FREEDOM: f64 = 4.0;

/// Scale of each balance by bin, by track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceScales {
    width_m: f64,
    tracks: BTreeMap<String, BTreeMap<i64, [f64; BALANCES]>>,
}

impl PlaceScales {
    /// From the residuals of runs, by balance, in bins of this width \[m\].
    pub fn estimate<R: AsRef<[Vec<f64>]>>(frames: &[Frame], rows: &[R], width_m: f64) -> Self {
        /// Mean squares of the runs, and the rows of all.
        type Squares = (Vec<f64>, f64);
        let mut squares: [BTreeMap<(&str, i64), Squares>; BALANCES] = Default::default();
        for (frame, rows) in frames.iter().zip(rows) {
            for (c, squares) in squares.iter_mut().enumerate() {
                let of_rows = rows.as_ref()[c].iter().map(|r| r * r);
                for (bin, own) in frame.sums_by_bin(of_rows, width_m) {
                    let (runs, n) = squares.entry((frame.track.as_str(), bin)).or_default();
                    runs.push(own.mean());
                    *n += own.count;
                }
            }
        }
        let mut tracks: BTreeMap<String, BTreeMap<i64, [f64; BALANCES]>> = BTreeMap::new();
        for (c, squares) in squares.into_iter().enumerate() {
            let places = squares.into_iter();
            let places: Vec<_> = places
                .map(|(at, (runs, n))| (at, median(runs).unwrap_or(0.0), n))
                .collect();
            let reference = median(places.iter().map(|(_, q, _)| *q)).unwrap_or(0.0);
            for ((track, bin), q, n) in places.into_iter().filter(|_| reference > 0.0) {
                let bins = tracks.entry(track.to_owned()).or_default();
                let scale = ((FREEDOM + n * q / reference) / (FREEDOM + n)).sqrt();
                bins.entry(bin).or_insert([1.0; BALANCES])[c] = scale;
            }
        }
        Self { width_m, tracks }
    }

    /// The scales at these places of a track; 1 in bins without rows.
    pub fn along(&self, track: &str, places: &[f64]) -> Vec<[f64; BALANCES]> {
        let bins = self.tracks.get(track);
        let at = |s: &f64| {
            let scales = bins.and_then(|bins| bins.get(&bin_of(*s, self.width_m)));
            scales.copied().unwrap_or([1.0; BALANCES])
        };
        places.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::runs::recordings::smooth_run::steady_run;
    use crate::null::random::{normal, stream};

    /// Noise, five times as large behind 700 m in the longitudinal balance of all runs, and behind
    /// 300 m in the lateral balance of two.
    fn rows(frames: &[Frame]) -> Vec<[Vec<f64>; BALANCES]> {
        let mut rng = stream(5, 1, 2);
        let of = |(i, frame): (usize, &Frame)| {
            let mut noise = |from: f64, loud: bool| -> Vec<f64> {
                let by = |s: &f64| if loud && *s > from { 5.0 } else { 1.0 };
                frame
                    .rows(&frame.s)
                    .iter()
                    .map(|s| by(s) * normal(&mut rng))
                    .collect()
            };
            [noise(700.0, true), noise(300.0, i < 2), Vec::new()]
        };
        frames.iter().enumerate().map(of).collect()
    }

    /// A bin has some 60 rows of 9 runs: medians of mean squares scatter by a fifth.
    #[test]
    fn scales_follow_what_most_runs_share() {
        // Of 900 m.
        let frames = vec![steady_run("east", 3000); 9];
        let scales = PlaceScales::estimate(&frames, &rows(&frames), 20.0);
        let at = |s: f64, c: usize| scales.along("east", &[s])[0][c];
        for s in [210.0, 410.0, 610.0] {
            assert!((at(s, 0) - 1.0).abs() < 0.4 && (at(s, 1) - 1.0).abs() < 0.4);
        }
        assert!((at(810.0, 0) / 5.0 - 1.0).abs() < 0.3, "{}", at(810.0, 0));
        assert_eq!(at(410.0, 2), 1.0);
        assert_eq!(scales.along("west", &[810.0]), [[1.0; BALANCES]]);
    }
}
