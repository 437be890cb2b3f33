//! Specific force less the acceleration of the motion: gravity, which has one size and turns with
//! the body.
//!
//! ```text
//! u = a - (dv/dt + w x v),   v = (v cos(alpha), -v sin(alpha), 0)        what lifts against gravity, in the body's axes
//! du/dt + w x u = 0,         |u| = g                                     [m/s3], [m/s2]
//! ```
//!
//! The three components of the first are relations between accelerations, rates, speed and slip.
//! Each is judged by its residual over the sum of its terms, both as mean squares: near 0 where all
//! channels are right, 1 where nothing cancels. In 44 simulated runs of a bobsled (its
//! accelerometer 0.37 m off) it is below 0.1, 0.03 and 0.01 for x, y and z, in the real car's 0.06
//! and 0.05 for x and y.

use std::borrow::Cow;
use std::ops::{Div, Index, IndexMut, Range, Sub};

use nalgebra::{DMatrix, DVector, Vector3};

use crate::column::{COLUMNS, SENSORS, Sensor};
use crate::friction::GRAVITY;
use crate::motion::state::lever_acceleration;
use crate::record::run::Run;
use crate::series::median;

/// Mean square of the terms [m2/s6] below which nothing moves enough to be judged.
const STILL: f64 = 1e-3;
/// Ratios below this are those of places and noise.
const FLOOR: f64 = 0.01;
/// Share by which the lift may differ from gravity before it counts.
const LEVEL: f64 = 0.1;

/// How well the channels of a run agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Agreement {
    /// Residual of each relation over its terms, mean squares; `None` where it cannot be judged.
    pub residual: [Option<f64>; 3],
    /// Median size of the lift [m/s2]; `None` without a vertical accelerometer.
    pub lift: Option<f64>,
}

/// The relations at one instant.
struct Instant {
    /// Terms of each, that of its own accelerometer first [m/s3].
    terms: [[f64; 5]; 3],
    /// Specific force less the acceleration of the motion [m/s2].
    lift: Vector3<f64>,
}

impl Instant {
    fn residual(&self, axis: usize) -> f64 {
        self.terms[axis].iter().sum()
    }
}

/// The relations at every instant of a run; a channel that is not recorded counts as 0, the
/// vertical accelerometer as gravity.
fn instants(slow: &Slow) -> Vec<Instant> {
    let force = slow.vectors(Sensor::ACCELEROMETER, [0.0, 0.0, GRAVITY]);
    let turn = slow.vectors(Sensor::GYROSCOPE, [0.0; 3]);
    let motion = [Sensor::Speed, Sensor::Slip].map(|sensor| slow.channel(sensor, 0.0));
    let pairs = motion[0].iter().zip(motion[1].iter());
    let velocity = pairs.map(|(v, alpha)| Vector3::new(v * alpha.cos(), -v * alpha.sin(), 0.0));
    let velocity: Vec<Vector3<f64>> = velocity.collect();
    let growth = slow.rate(&velocity);
    // dv/dt + w x v, of which each axis has two terms.
    let of_motion = |i: usize| {
        let (w, v, growth) = (turn[i], velocity[i], growth[i]);
        let first = Vector3::new(growth.x, growth.y, -w.y * v.x);
        (first, Vector3::new(-w.z * v.y, w.z * v.x, w.x * v.y))
    };
    let (first, second): (Vec<_>, Vec<_>) = (0..slow.len()).map(of_motion).unzip();
    let lift = |i: usize| force[i] - first[i] - second[i];
    let rates = [&force, &first, &second].map(|x| slow.rate(x));
    let instant = |i: usize| {
        let (w, u) = (turn[i], lift(i));
        let [own, first, second] = [0, 1, 2].map(|part: usize| rates[part][i]);
        let terms = |axis: usize| {
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            let turned = [w[j] * u[k], -w[k] * u[j]];
            [own[axis], -first[axis], -second[axis], turned[0], turned[1]]
        };
        Instant {
            terms: [0, 1, 2].map(terms),
            lift: u,
        }
    };
    slow.inner(2).map(instant).collect()
}

/// The factor on an accelerometer's axis with which its relation is satisfied, with its standard
/// error.
pub(super) fn factor(slow: &Slow, axis: usize) -> Option<Coefficient> {
    slow.channels[axis].as_ref()?;
    let terms = instants(slow).into_iter().map(|at| at.terms[axis]);
    let pairs = terms.map(|[own, rest @ ..]| (own, -rest.iter().sum::<f64>()));
    let (own, rest): (Vec<f64>, Vec<f64>) = pairs.unzip();
    coefficients(&[&own], &rest)?.first().copied()
}

impl Agreement {
    /// Of the slow channels of a run.
    pub fn of(slow: &Slow) -> Agreement {
        let all = instants(slow);
        let weighed = slow[Sensor::Az].is_some();
        let turns = slow[Sensor::RollRate].is_some() || slow[Sensor::PitchRate].is_some();
        let [along, across] = [Sensor::Ax, Sensor::Ay].map(|sensor| slow[sensor].is_some());
        let judged = [along, across, weighed && turns];
        let residual = |axis: usize| {
            let residual: f64 = all.iter().map(|at| at.residual(axis).powi(2)).sum();
            let squares = |at: &Instant| at.terms[axis].iter().map(|t| t * t).sum::<f64>();
            let terms: f64 = all.iter().map(squares).sum();
            (judged[axis] && terms > STILL * all.len() as f64).then(|| residual / terms)
        };
        Agreement {
            residual: [0, 1, 2].map(residual),
            lift: median(all.iter().map(|at| at.lift.norm())).filter(|_| weighed),
        }
    }

    /// Whether the relations across and up have residuals below a limit, as far as they can be
    /// judged.
    pub fn is_below(&self, limit: f64) -> bool {
        let mut judged = self.residual[1..].iter().flatten();
        judged.all(|residual| *residual < limit)
    }

    /// Disagreement as a sum of logarithms, so that a factor in any relation has the same weight;
    /// lower is better.
    pub fn score(&self) -> f64 {
        let relations = self.residual.iter().flatten();
        let sum: f64 = relations.map(|residual| (residual + FLOOR).ln()).sum();
        let level = |lift: f64| ((lift / GRAVITY).ln() / LEVEL).powi(2).min(10.0);
        sum + self.lift.map_or(0.0, level)
    }
}

/// Corner of the Gaussian low pass [Hz].
const CORNER_HZ: f64 = 1.0;
/// Rate of the slow channels [Hz].
const RATE_HZ: f64 = 20.0;
/// Shortest time that is judged [s].
const LEAST_S: f64 = 5.0;

/// Channels of a run below 1 Hz, in the order of [`COLUMNS`]; `None` where one is not recorded.
#[derive(Clone, Debug)]
pub(super) struct Slow {
    /// Time between samples [s].
    pub dt_s: f64,
    /// The channels.
    pub channels: [Option<Vec<f64>>; SENSORS],
    /// Stretches without a gap.
    pub pieces: Vec<Range<usize>>,
}

impl Index<Sensor> for Slow {
    type Output = Option<Vec<f64>>;

    fn index(&self, of: Sensor) -> &Option<Vec<f64>> {
        &self.channels[of as usize]
    }
}

impl IndexMut<Sensor> for Slow {
    fn index_mut(&mut self, of: Sensor) -> &mut Option<Vec<f64>> {
        &mut self.channels[of as usize]
    }
}

impl Slow {
    pub fn len(&self) -> usize {
        self.pieces.last().map_or(0, |piece| piece.end)
    }

    /// A channel, `absent` throughout where it is not recorded.
    fn channel(&self, sensor: Sensor, absent: f64) -> Cow<'_, [f64]> {
        match &self[sensor] {
            Some(x) => x.into(),
            None => vec![absent; self.len()].into(),
        }
    }

    /// A vector at every sample by the sensors of its axes.
    pub fn vectors(&self, axes: [Sensor; 3], absent: [f64; 3]) -> Vec<Vector3<f64>> {
        let axes: [_; 3] = std::array::from_fn(|axis| self.channel(axes[axis], absent[axis]));
        let vector = |i: usize| Vector3::from_fn(|axis, _| axes[axis][i]);
        (0..self.len()).map(vector).collect()
    }

    /// Samples that are so many or more from the ends of their stretch.
    pub fn inner(&self, margin: usize) -> impl Iterator<Item = usize> {
        let pieces = self.pieces.iter();
        pieces.flat_map(move |piece| piece.start + margin..piece.end.saturating_sub(margin))
    }

    /// Rate of slow numbers or vectors, stretch by stretch.
    pub fn rate<T>(&self, x: &[T]) -> Vec<T>
    where
        T: Copy + Default + Sub<Output = T> + Div<f64, Output = T>,
    {
        let mut rates = vec![T::default(); x.len()];
        for piece in &self.pieces {
            for i in piece.clone() {
                let (before, after) = (i.max(piece.start + 1) - 1, (i + 1).min(piece.end - 1));
                rates[i] = (x[after] - x[before]) / ((after - before) as f64 * self.dt_s);
            }
        }
        rates
    }

    /// The slow part of a run; `None` where it is shorter than five seconds.
    pub fn of(run: &Run) -> Option<Slow> {
        // |H(f)| = exp(-2 pi^2 f^2 sigma^2) = 2^-1/2 at the corner.
        let sigma = (0.5_f64.ln().abs() / 4.0).sqrt() / (std::f64::consts::PI * CORNER_HZ);
        let half = (4.0 * sigma / run.dt_s).ceil() as usize;
        let at = |k: usize| (k as f64 - half as f64) * run.dt_s / sigma;
        let weight = |k: usize| (-0.5 * at(k).powi(2)).exp();
        let weights: Vec<f64> = (0..=2 * half).map(weight).collect();
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
pub(super) type Coefficient = (f64, f64);

/// Coefficients of columns and a constant for these values, with errors by leaving out a twentieth
/// at a time; `None` where the columns do not determine them.
pub(super) fn coefficients(columns: &[&[f64]], values: &[f64]) -> Option<Vec<Coefficient>> {
    const BLOCKS: usize = 20;
    let width = columns.len() + 1;
    let largest = |x: &&[f64]| x.iter().fold(1e-300_f64, |most, y| most.max(y.abs()));
    let scale: Vec<f64> = columns.iter().map(largest).collect();
    let empty = (DMatrix::zeros(width, width), DVector::zeros(width));
    let mut blocks = vec![empty.clone(); BLOCKS];
    for (i, y) in values.iter().enumerate() {
        let own = columns.iter().zip(&scale).map(|(x, scale)| x[i] / scale);
        let x = DVector::from_iterator(width, own.chain([1.0]));
        let block = &mut blocks[i * BLOCKS / values.len()];
        block.0 += &x * x.transpose();
        block.1 += &x * *y;
    }
    let sum = blocks.iter().fold(empty, |(a, b), (c, d)| (a + c, b + d));
    let solve = |a: DMatrix<f64>, b: DVector<f64>| a.cholesky().map(|factor| factor.solve(&b));
    let all = solve(sum.0.clone(), sum.1.clone())?;
    let without = blocks.iter().map(|(a, b)| solve(&sum.0 - a, &sum.1 - b));
    let without: Vec<DVector<f64>> = without.collect::<Option<_>>()?;
    let share = (BLOCKS - 1) as f64 / BLOCKS as f64;
    let mean = |k: usize| without.iter().map(|b| b[k]).sum::<f64>() / BLOCKS as f64;
    let error = |k: usize| {
        let squares: f64 = without.iter().map(|b| (b[k] - mean(k)).powi(2)).sum();
        (share * squares).sqrt()
    };
    let found = (0..columns.len()).map(|k| (all[k] / scale[k], error(k) / scale[k]));
    Some(found.collect())
}

/// How late each channel is relative to the others, if it alone is [s], with its standard error; in
/// the order of the columns.
///
/// The residuals of the relations are fitted by their change for the channel read a hundredth of a
/// second later, together with their changes for the accelerometer or the slip sensor a metre off.
/// Without a slip sensor the slip's own part of the lateral force would pass for a delay of it: there
/// is none.
pub(super) fn delays(slow: &Slow) -> [Option<Coefficient>; 8] {
    const STEP_S: f64 = 0.01;
    let all = instants(slow);
    let scale = [0, 1, 2].map(|axis: usize| {
        let terms = all.iter().flat_map(|at| at.terms[axis]);
        let squares = terms.map(|t| t * t).sum::<f64>();
        let known = slow.channels[axis].is_some() && squares > 0.0;
        if known { squares.sqrt().recip() } else { 0.0 }
    });
    let residuals = |slow: &Slow| -> Vec<f64> {
        let all = instants(slow);
        let scaled = |at: &Instant| [0, 1, 2].map(|axis| scale[axis] * at.residual(axis));
        all.iter().flat_map(scaled).collect()
    };
    let now = residuals(slow);
    let change = |other: &Slow| -> Vec<f64> {
        let other = residuals(other);
        other.iter().zip(&now).map(|(a, b)| a - b).collect()
    };
    let mut places: Vec<Vec<f64>> = (0..3).map(|axis| change(&displaced(slow, axis))).collect();
    let mut ahead = slow.clone();
    let sensors = [Sensor::YawRate, Sensor::Speed].map(|sensor| slow[sensor].as_ref());
    if let (Some(alpha), [Some(yaw), Some(v)]) = (&mut ahead[Sensor::Slip], sensors) {
        for (alpha, (r, v)) in alpha.iter_mut().zip(yaw.iter().zip(v)) {
            *alpha -= r / v;
        }
    }
    places.push(change(&ahead));
    places.retain(|place| place.iter().any(|x| *x != 0.0));
    let off: Vec<f64> = now.iter().map(|x| -x).collect();
    std::array::from_fn(|c| {
        if c == Sensor::Ay as usize && slow[Sensor::Slip].is_none() {
            return None;
        }
        let mut later = slow.clone();
        let rates = slow.rate(slow.channels[c].as_ref()?);
        for (x, rate) in later.channels[c].as_mut()?.iter_mut().zip(rates) {
            *x += STEP_S * rate;
        }
        let change = change(&later);
        let columns = std::iter::once(&change).chain(&places);
        let columns: Vec<&[f64]> = columns.map(Vec::as_slice).collect();
        let (steps, error) = *coefficients(&columns, &off)?.first()?;
        Some((STEP_S * steps, STEP_S * error))
    })
}

/// The readings of the accelerometer a metre further along an axis.
fn displaced(slow: &Slow, axis: usize) -> Slow {
    let mut moved = slow.clone();
    let rates = slow.vectors(Sensor::GYROSCOPE, [0.0; 3]);
    let turning = slow.rate(&rates);
    let place = Vector3::from_fn(|k, _| if k == axis { 1.0 } else { 0.0 });
    for (i, (w, dw)) in rates.into_iter().zip(turning).enumerate() {
        let more = lever_acceleration(w.into(), dw.into(), place.into());
        for (channel, more) in moved.channels[..3].iter_mut().zip(more) {
            if let Some(a) = channel {
                a[i] += more;
            }
        }
    }
    moved
}
