//! What the motion leaves of the specific force: gravity, which has one size and turns with the body.
//!
//! ```text
//! u = a - (dv/dt + w x v),   v = (v cos(alpha), -v sin(alpha), 0)        what lifts against gravity, in the body's axes
//! du/dt + w x u = 0,         |u| = g                                     [m/s3], [m/s2]
//! ```
//!
//! The three components of the first are relations between accelerations, rates, speed and slip. Each is judged by what is
//! left of it over the sum of its terms, both as mean squares: near 0 where all channels are what they should be, 1 where
//! nothing cancels. In 44 simulated runs of a bobsled (its accelerometer 0.37 m off) it is below 0.1, 0.03 and 0.01 for x, y
//! and z, in the real car's 0.06 and 0.05 for x and y.

use crate::friction::GRAVITY;

use crate::record::check::relations::coefficients::{Coefficient, coefficients};
use crate::record::check::relations::slow::Slow;

/// Mean square of the terms [m2/s6] below which nothing moves enough to be judged.
const STILL: f64 = 1e-3;
/// Ratios below this are those of places and noise; a ratio is judged beside it.
const FLOOR: f64 = 0.01;
/// Share by which the lift may differ from gravity before it counts.
const LEVEL: f64 = 0.1;

/// How well the channels of a run agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// What is left of each relation over its terms, mean squares; `None` where it cannot be judged.
    pub left: [Option<f64>; 3],
    /// Median size of the lift [m/s2]; `None` without a vertical accelerometer.
    pub lift: Option<f64>,
}

/// The relations at one instant.
pub struct Instant {
    /// Terms of each, that of its own accelerometer first [m/s3].
    pub terms: [[f64; 5]; 3],
    /// What lifts against gravity [m/s2].
    lift: [f64; 3],
}

/// The relations at every instant of a run; what is not recorded counts as still, or as weighing gravity.
pub fn instants(slow: &Slow) -> Vec<Instant> {
    let mut all = Vec::new();
    for piece in &slow.pieces {
        let channel = |c: usize, absent: f64| match &slow.channels[c] {
            Some(x) => x[piece.clone()].to_vec(),
            None => vec![absent; piece.len()],
        };
        let a = [channel(0, 0.0), channel(1, 0.0), channel(2, GRAVITY)];
        let [p, q, r] = [3, 4, 5].map(|c| channel(c, 0.0));
        let (v, alpha) = (channel(6, 0.0), channel(7, 0.0));
        let n = piece.len();
        let ahead: Vec<f64> = (0..n).map(|i| v[i] * alpha[i].cos()).collect();
        let aside: Vec<f64> = (0..n).map(|i| -v[i] * alpha[i].sin()).collect();
        let rate = |x: &[f64]| -> Vec<f64> {
            let slope =
                |i: usize| (x[(i + 1).min(n - 1)] - x[i.saturating_sub(1)]) / (2.0 * slow.dt_s);
            (0..n).map(slope).collect()
        };
        // w x v, along the axes.
        let turned = |sign: f64, w: &[f64], v: &[f64]| -> Vec<f64> {
            w.iter().zip(v).map(|(w, v)| sign * w * v).collect()
        };
        let (ahead_rate, aside_rate) = (rate(&ahead), rate(&aside));
        let still = vec![0.0; n];
        // What the accelerometers feel beside gravity, in parts.
        let parts = [
            [ahead_rate, turned(-1.0, &r, &aside)],
            [aside_rate, turned(1.0, &r, &ahead)],
            [turned(-1.0, &q, &ahead), turned(1.0, &p, &aside)],
        ];
        let lift: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            let [one, two] = &parts[axis];
            (0..n).map(|i| a[axis][i] - one[i] - two[i]).collect()
        });
        let own = a.each_ref().map(|x| rate(x));
        let parts = parts.map(|pair| pair.map(|part| rate(&part)));
        let (w, u) = ([&p, &q, &r, &still], &lift);
        for i in 2..n.saturating_sub(2) {
            let terms = std::array::from_fn(|axis| {
                let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
                [
                    own[axis][i],
                    -parts[axis][0][i],
                    -parts[axis][1][i],
                    w[j][i] * u[k][i],
                    -w[k][i] * u[j][i],
                ]
            });
            all.push(Instant {
                terms,
                lift: [u[0][i], u[1][i], u[2][i]],
            });
        }
    }
    all
}

/// By which factor an accelerometer's axis must be taken for its relation to hold, with its standard error.
pub fn factor(slow: &Slow, axis: usize) -> Option<Coefficient> {
    slow.channels[axis].as_ref()?;
    let all = instants(slow);
    let own: Vec<f64> = all.iter().map(|at| at.terms[axis][0]).collect();
    let rest = |at: &Instant| -at.terms[axis][1..].iter().sum::<f64>();
    let rows: Vec<(usize, f64)> = all.iter().map(rest).enumerate().collect();
    coefficients(&[&own], &rows)?.first().copied()
}

impl Agreement {
    /// Of the slow channels of a run.
    pub fn of(slow: &Slow) -> Agreement {
        let all = instants(slow);
        let mut lifts: Vec<f64> = all
            .iter()
            .map(|at| at.lift.iter().map(|u| u * u).sum::<f64>().sqrt())
            .collect();
        let weighed = slow.channels[2].is_some();
        let turns = slow.channels[3].is_some() || slow.channels[4].is_some();
        let there = [
            slow.channels[0].is_some(),
            slow.channels[1].is_some(),
            weighed && turns,
        ];
        let left = |axis: usize| {
            let squares =
                |of: fn(&[f64; 5]) -> f64| all.iter().map(|at| of(&at.terms[axis])).sum::<f64>();
            let left = squares(|terms| terms.iter().sum::<f64>().powi(2));
            let terms = squares(|terms| terms.iter().map(|t| t * t).sum());
            (there[axis] && terms > STILL * all.len() as f64).then(|| left / terms)
        };
        let middle = lifts.len() / 2;
        Agreement {
            left: [left(0), left(1), left(2)],
            lift: (weighed && !lifts.is_empty())
                .then(|| *lifts.select_nth_unstable_by(middle, f64::total_cmp).1),
        }
    }

    /// Disagreement as a sum of logarithms, so that a factor in any relation counts alike; lower is better.
    pub fn score(&self) -> f64 {
        let left: f64 = self
            .left
            .iter()
            .flatten()
            .map(|left| (left + FLOOR).ln())
            .sum();
        let level = |lift: f64| ((lift / GRAVITY).ln() / LEVEL).powi(2).min(10.0);
        left + self.lift.map_or(0.0, level)
    }
}
