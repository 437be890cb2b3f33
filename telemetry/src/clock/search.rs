//! Where two sides of relations fit best, over all delays.

use crate::clock::pair::Sides;

/// Most samples of a side in the first search: its cost grows with their square.
const MOST: f64 = 1200.0;

/// Fewest pairs of samples that a delay is judged by.
const LEAST_PAIRS: usize = 60;

/// Least share of the shorter side that both have in common.
const LEAST_SHARE: f64 = 0.3;

/// A second best fit of more than this share of the best makes the delay ambiguous.
const AMBIGUOUS: f64 = 0.8;

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Found {
    /// The delay [s], within a step of the search.
    Delay(f64),
    /// Two delays fit alike [s].
    Ambiguous(f64, f64),
    /// Nothing overlaps long enough.
    Nothing,
}

/// Rate at which sides are compared first [Hz], not above `most_hz`.
pub(crate) fn first_rate(spans: [[f64; 2]; 2], most_hz: f64) -> f64 {
    let longest = spans
        .iter()
        .map(|span| span[1] - span[0])
        .fold(1e-3, f64::max);
    most_hz.min(MOST / longest)
}

/// The delay at which all sides together fit best: the largest sum of `-n ln(1 - rho^2)` over relations with a positive
/// correlation rho of n samples. What is recorded with the right sign correlates positively.
///
/// `within` bounds the delay [s].
pub(crate) fn search(sides: &[Sides], rate_hz: f64, within: Option<f64>) -> Found {
    let step = 1.0 / rate_hz;
    // Delays by which any two sides overlap.
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for side in sides {
        let [left, right] = side.spans();
        let (late, known) = if side.ahead(1.0) > 0.0 {
            (left, right)
        } else {
            (right, left)
        };
        range = [
            range[0].min(late[0] - known[1]),
            range[1].max(late[1] - known[0]),
        ];
    }
    if let Some(most) = within {
        range = [range[0].max(-most), range[1].min(most)];
    }
    let lags = ((range[1] - range[0]) / step).floor();
    if !(0.0..1e6).contains(&lags) {
        return Found::Nothing;
    }
    let tables: Vec<Sampled> = sides.iter().map(|side| Sampled::of(side, step)).collect();
    let scores: Vec<f64> = (0..=lags as usize)
        .map(|lag| {
            let delay = range[0] + lag as f64 * step;
            let fits = sides
                .iter()
                .zip(&tables)
                .filter_map(|(side, table)| table.fit(side.ahead(delay)));
            fits.map(|(pairs, rho)| -pairs * (1.0 - rho.clamp(0.0, 0.999_999).powi(2)).ln())
                .sum()
        })
        .collect();
    let Some(best) = (0..scores.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b])) else {
        return Found::Nothing;
    };
    if scores[best] <= 0.0 {
        return Found::Nothing;
    }
    let delay = |lag: usize| range[0] + lag as f64 * step;
    // The best fit's own hill: down to half of it, or to where it rises again.
    let below = |lag: &usize| scores[*lag] < 0.5 * scores[best];
    let from = (0..best).rev().find(below).unwrap_or(0);
    let to = (best..scores.len()).find(below).unwrap_or(scores.len());
    let others = (0..from).chain(to..scores.len());
    match others.max_by(|a, b| scores[*a].total_cmp(&scores[*b])) {
        Some(second) if scores[second] > AMBIGUOUS * scores[best] => {
            Found::Ambiguous(delay(best), delay(second))
        }
        _ => Found::Delay(delay(best)),
    }
}

/// Both sides at uniform times of their own clocks; NaN where there is none.
struct Sampled {
    left: Vec<f64>,
    right: Vec<f64>,
    /// From the first right time to the first left time [s].
    apart: f64,
    step: f64,
}

impl Sampled {
    fn of(side: &Sides, step: f64) -> Sampled {
        let [left, right] = side.spans();
        let count = |span: [f64; 2]| ((span[1] - span[0]) / step) as usize + 1;
        let at = |span: [f64; 2], i: usize| span[0] + i as f64 * step;
        Sampled {
            left: (0..count(left))
                .map(|i| side.left(at(left, i)).map_or(f64::NAN, |l| l[0]))
                .collect(),
            // A speed of the other clock is slow beside what it multiplies; it is brought into place when the delay is refined.
            right: (0..count(right))
                .map(|i| {
                    side.right(at(right, i), left[0] - right[0])
                        .map_or(f64::NAN, |r| r[0])
                })
                .collect(),
            apart: left[0] - right[0],
            step,
        }
    }

    /// Pairs and correlation with the right side brought ahead by so much [s].
    fn fit(&self, ahead: f64) -> Option<(f64, f64)> {
        // Right sample j stands at the place of left sample j + shift.
        let shift = ((ahead - self.apart) / self.step).round() as i64;
        let from = (-shift).max(0);
        let to = (self.left.len() as i64 - shift).min(self.right.len() as i64);
        if to <= from {
            return None;
        }
        let mut sums = [0.0; 6];
        for j in from..to {
            let (a, b) = (self.left[(j + shift) as usize], self.right[j as usize]);
            if a.is_nan() || b.is_nan() {
                continue;
            }
            for (sum, term) in sums.iter_mut().zip([1.0, a, b, a * a, b * b, a * b]) {
                *sum += term;
            }
        }
        let [n, a, b, aa, bb, ab] = sums;
        let shorter = self.left.len().min(self.right.len()) as f64;
        if n < LEAST_PAIRS as f64 || n < LEAST_SHARE * shorter {
            return None;
        }
        let spread = ((aa - a * a / n) * (bb - b * b / n)).sqrt();
        let rho = (ab - a * b / n) / spread;
        rho.is_finite().then_some((n, rho))
    }
}
