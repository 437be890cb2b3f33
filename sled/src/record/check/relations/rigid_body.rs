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

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::column::COLUMNS;
use crate::friction::GRAVITY;
use crate::record::run::Run;

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

/// Corner of the Gaussian low pass [Hz].
const CORNER_HZ: f64 = 1.0;
/// Samples that are kept [Hz].
const RATE_HZ: f64 = 20.0;
/// Shortest time that is judged [s].
const LEAST_S: f64 = 5.0;

/// Channels of a run below 1 Hz, in the order of [`COLUMNS`]; `None` where one is not recorded.
#[derive(Clone, Debug)]
pub struct Slow {
    /// Time between samples [s].
    pub dt_s: f64,
    /// The channels.
    pub channels: [Option<Vec<f64>>; 10],
    /// Stretches without a gap.
    pub pieces: Vec<Range<usize>>,
}

impl Slow {
    /// The slow part of a run; `None` where less than five seconds of it are left.
    pub fn of(run: &Run) -> Option<Slow> {
        // |H(f)| = exp(-2 pi^2 f^2 sigma^2) = 2^-1/2 at the corner.
        let sigma = (0.5_f64.ln().abs() / 4.0).sqrt() / (std::f64::consts::PI * CORNER_HZ);
        let half = (4.0 * sigma / run.dt_s).ceil() as usize;
        let at = |k: usize| (k as f64 - half as f64) * run.dt_s / sigma;
        let weights: Vec<f64> = (0..=2 * half)
            .map(|k| (-0.5 * at(k).powi(2)).exp())
            .collect();
        let sum: f64 = weights.iter().sum();
        let stride = (1.0 / (RATE_HZ * run.dt_s)).round().max(1.0) as usize;
        let centres = |piece: &Range<usize>| {
            (piece.start + half..piece.end.saturating_sub(half)).step_by(stride)
        };
        let mut pieces = Vec::new();
        let mut count = 0;
        let mut retained = Vec::new();
        for piece in &run.gaps.pieces {
            let length = centres(piece).count();
            // Two samples on each side are spent on derivatives.
            if length > 8 {
                pieces.push(count..count + length);
                retained.extend(centres(piece));
                count += length;
            }
        }
        let dt_s = stride as f64 * run.dt_s;
        if (count as f64) * dt_s < LEAST_S {
            return None;
        }
        let smooth = |x: &Vec<f64>| {
            let one = |i: &usize| {
                let window = x[i - half..=i + half].iter().zip(&weights);
                window.map(|(x, w)| x * w).sum::<f64>() / sum
            };
            retained.iter().map(one).collect::<Vec<f64>>()
        };
        Some(Slow {
            dt_s,
            channels: COLUMNS.map(|name| run.columns.get(name).map(smooth)),
            pieces,
        })
    }
}

/// A coefficient and its standard error.
pub type Coefficient = (f64, f64);

/// Coefficients of columns and a constant, with errors by leaving out a twentieth at a time; `rows` are places in the columns
/// and values. `None` where the columns do not determine them.
pub fn coefficients(columns: &[&[f64]], rows: &[(usize, f64)]) -> Option<Vec<Coefficient>> {
    const BLOCKS: usize = 20;
    let width = columns.len() + 1;
    let scale: Vec<f64> = columns
        .iter()
        .map(|x| {
            x.iter()
                .fold(0.0_f64, |most, y| most.max(y.abs()))
                .max(1e-300)
        })
        .collect();
    let empty = (DMatrix::zeros(width, width), DVector::zeros(width));
    let mut blocks = vec![empty.clone(); BLOCKS];
    for (k, (i, y)) in rows.iter().enumerate() {
        let own = columns.iter().zip(&scale).map(|(x, scale)| x[*i] / scale);
        let x = DVector::from_iterator(width, own.chain([1.0]));
        let block = &mut blocks[k * BLOCKS / rows.len()];
        block.0 += &x * x.transpose();
        block.1 += &x * *y;
    }
    let sum = blocks.iter().fold(empty, |(a, b), (c, d)| (a + c, b + d));
    let solve = |a: DMatrix<f64>, b: DVector<f64>| a.cholesky().map(|factor| factor.solve(&b));
    let all = solve(sum.0.clone(), sum.1.clone())?;
    let without: Vec<DVector<f64>> = blocks
        .iter()
        .map(|(a, b)| solve(&sum.0 - a, &sum.1 - b))
        .collect::<Option<_>>()?;
    let share = (BLOCKS - 1) as f64 / BLOCKS as f64;
    let mean = |k: usize| without.iter().map(|b| b[k]).sum::<f64>() / BLOCKS as f64;
    let error = |k: usize| {
        let squares: f64 = without.iter().map(|b| (b[k] - mean(k)).powi(2)).sum();
        (share * squares).sqrt()
    };
    let found = (0..columns.len()).map(|k| (all[k] / scale[k], error(k) / scale[k]));
    Some(found.collect())
}

/// How late each channel is beside the others, if it alone is [s], with its standard error; in the order of the columns.
///
/// What is left of the relations is fitted by how it would change were the channel read a hundredth of a second later, beside
/// how it would change were the accelerometer or the slip sensor a metre off.
pub fn delays(slow: &Slow) -> [Option<Coefficient>; 8] {
    const STEP_S: f64 = 0.01;
    let all = instants(slow);
    let there = [0, 1, 2].map(|axis: usize| slow.channels[axis].is_some());
    let scale = [0, 1, 2].map(|axis: usize| {
        let squares = all
            .iter()
            .flat_map(|at| at.terms[axis])
            .map(|t| t * t)
            .sum::<f64>();
        if there[axis] && squares > 0.0 {
            squares.sqrt().recip()
        } else {
            0.0
        }
    });
    let left = |slow: &Slow| -> Vec<f64> {
        let sum = |terms: &[f64; 5]| terms.iter().sum::<f64>();
        let instants = instants(slow);
        let each = instants
            .iter()
            .flat_map(|at| (0..3).map(|axis| scale[axis] * sum(&at.terms[axis])));
        each.collect()
    };
    let now = left(slow);
    let change =
        |other: &Slow| -> Vec<f64> { left(other).iter().zip(&now).map(|(a, b)| a - b).collect() };
    let mut places: Vec<Vec<f64>> = (0..3).map(|axis| change(&displaced(slow, axis))).collect();
    let mut ahead = slow.clone();
    if let (Some(alpha), Some(yaw), Some(v)) =
        (&mut ahead.channels[7], &slow.channels[5], &slow.channels[6])
    {
        for (alpha, (r, v)) in alpha.iter_mut().zip(yaw.iter().zip(v)) {
            *alpha -= r / v;
        }
    }
    places.push(change(&ahead));
    places.retain(|place| place.iter().any(|x| *x != 0.0));
    std::array::from_fn(|c| {
        let x = slow.channels[c].as_ref()?;
        let mut later = slow.clone();
        let rates = rate(slow, x);
        for (x, rate) in later.channels[c].as_mut()?.iter_mut().zip(rates) {
            *x += STEP_S * rate;
        }
        let change = change(&later);
        let columns: Vec<&[f64]> = std::iter::once(&change)
            .chain(&places)
            .map(Vec::as_slice)
            .collect();
        let rows: Vec<(usize, f64)> = now.iter().map(|left| -left).enumerate().collect();
        let (steps, error) = *coefficients(&columns, &rows)?.first()?;
        Some((STEP_S * steps, STEP_S * error))
    })
}

/// What the accelerometers would read a metre further along an axis: `dw/dt x e + w x (w x e)` more.
fn displaced(slow: &Slow, axis: usize) -> Slow {
    let mut moved = slow.clone();
    let n = slow.pieces.last().map_or(0, |piece| piece.end);
    let still = vec![0.0; n];
    let w = [3, 4, 5].map(|c: usize| slow.channels[c].as_ref().unwrap_or(&still));
    let turning = w.map(|w| rate(slow, w));
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    for i in 0..n {
        // dw/dt x e has components along the other two axes, w x (w x e) along all: w_axis w - |w|^2 e.
        let mut more = [0.0; 3];
        more[j] += turning[k][i];
        more[k] -= turning[j][i];
        let size: f64 = w.iter().map(|w| w[i] * w[i]).sum();
        for (to, own) in more.iter_mut().zip(w) {
            *to += w[axis][i] * own[i];
        }
        more[axis] -= size;
        for (channel, more) in moved.channels[..3].iter_mut().zip(more) {
            if let Some(a) = channel {
                a[i] += more;
            }
        }
    }
    moved
}

/// Rate of a slow channel, stretch by stretch.
fn rate(slow: &Slow, x: &[f64]) -> Vec<f64> {
    let mut rates = vec![0.0; x.len()];
    for piece in &slow.pieces {
        for i in piece.clone() {
            let (before, after) = (i.max(piece.start + 1) - 1, (i + 1).min(piece.end - 1));
            rates[i] = (x[after] - x[before]) / ((after - before) as f64 * slow.dt_s);
        }
    }
    rates
}
