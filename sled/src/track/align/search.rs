//! Where on the track a run lies, coarsely.

use crate::track::align::course::Course;
use crate::track::align::felt::Felt;

/// A straight line from own distance to that along the track, and how badly it fits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// What is added at the run's first metre [m].
    pub shift_m: f64,
    /// Growth of the distance along the track by the own one.
    pub stretch: f64,
    /// Mean square difference over variance, curvature and bank together.
    pub left: f64,
}

/// Shifts are tried two metres apart, which is well within the width of a curve's entry.
const STEP_M: f64 = 2.0;
/// Every so many metres are compared.
const EVERY: usize = 4;
/// Stretches that are tried: a wheel or an optical sensor is within 2 %.
const STRETCHES: [f64; 9] = [0.98, 0.985, 0.99, 0.995, 1.0, 1.005, 1.01, 1.015, 1.02];
/// Of the shorter of run and track, so much must overlap.
const LEAST_OVERLAP: f64 = 0.6;
/// Another place counts as another one from here on [m].
const APART_M: f64 = 15.0;

/// The best line and how badly the best elsewhere fits.
pub(crate) fn search(felt: &Felt, course: &Course) -> Option<(Line, f64)> {
    let length = felt.metres.len().min(course.metres.len());
    let least = (LEAST_OVERLAP * length as f64 / EVERY as f64) as usize;
    let base = course.from_m - felt.from_m;
    let reach = (1.0 - LEAST_OVERLAP) * length as f64
        + (course.metres.len() as f64 - felt.metres.len() as f64).abs();
    let count = (2.0 * reach / STEP_M) as usize + 1;
    let mut tried: Vec<Line> = Vec::new();
    for stretch in STRETCHES {
        for i in 0..count {
            let shift_m = base - reach + i as f64 * STEP_M;
            let left = left(felt, course, shift_m, stretch, least);
            tried.extend(left.map(|left| Line {
                shift_m,
                stretch,
                left,
            }));
        }
    }
    let best = *tried.iter().min_by(|a, b| a.left.total_cmp(&b.left))?;
    let middle = 0.5 * felt.metres.len() as f64;
    let place = |line: &Line| line.shift_m + line.stretch * middle;
    let elsewhere = tried
        .iter()
        .filter(|line| (place(line) - place(&best)).abs() > APART_M)
        .map(|line| line.left)
        .fold(f64::INFINITY, f64::min);
    Some((best, elsewhere))
}

fn left(felt: &Felt, course: &Course, shift: f64, stretch: f64, least: usize) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0);
    for i in (0..felt.metres.len()).step_by(EVERY) {
        let s = felt.from_m + shift + stretch * i as f64;
        if let Some((at, _)) = course.at(s).filter(|_| felt.metres[i][0].is_finite()) {
            for ((felt, at), spread) in felt.metres[i].iter().zip(at).zip(course.spread) {
                sum += 0.5 * ((felt - at) / spread).powi(2);
            }
            count += 1;
        }
    }
    (count >= least.max(1)).then(|| sum / count as f64)
}
