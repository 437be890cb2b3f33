//! Relations between the channels of one rigid body.
//!
//! The specific force `a` less the acceleration of the motion lifts against gravity, which has one
//! size and one direction. In the axes of the body, with the rates `w` and the speed `v` at the slip
//! angle `alpha`:
//!
//! ```text
//! D (a - D v) = 0,   |a - D v| = g,   D x = dx/dt + w x x,   v = (v cos(alpha), -v sin(alpha), 0)
//! ```
//!
//! Each component of the first relation is judged by its residual over the sum of its terms, both
//! as mean squares: near 0 where all channels are right, 1 where nothing cancels. In 44 simulated
//! runs of a bobsled (its accelerometer 0.37 m off) it is below 0.1, 0.03 and 0.01 for x, y and z, in
//! a real car's 0.06 and 0.05 for x and y.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::{Div, Index, IndexMut, Range, Sub};

use nalgebra::{DMatrix, DVector, Vector3};

use crate::column::{COLUMNS, SENSORS, Sensor};
use crate::friction::GRAVITY;
use crate::record::run::Run;
use crate::series::{median, root_mean_square};

/// Corner of the low pass [Hz].
const CORNER_HZ: f64 = 1.0;
/// Rate of the slow channels [Hz].
const RATE_HZ: f64 = 20.0;
/// Fewest samples of a stretch: derivatives spend two at each end.
const LEAST_SAMPLES: usize = 9;
/// Largest delay that is searched [s].
const MOST_LATE_S: f64 = 1.0;
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
    pieces: Vec<Range<usize>>,
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
    /// The slow part of a run by a Gaussian low pass; `None` where it is shorter than five seconds.
    pub fn of(run: &Run) -> Option<Slow> {
        // |H(f)| = exp(-2 pi^2 f^2 sigma^2) = 2^-1/2 at the corner.
        let sigma = (0.5_f64.ln().abs() / 4.0).sqrt() / (PI * CORNER_HZ * run.dt_s);
        let half = (4.0 * sigma).ceil() as usize;
        let weight = |k: usize| (-0.5 * ((k as f64 - half as f64) / sigma).powi(2)).exp();
        let weights: Vec<f64> = (0..=2 * half).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        let stride = (run.rate_hz() / RATE_HZ).round().max(1.0) as usize;
        let (mut centres, mut pieces) = (Vec::new(), Vec::new());
        for piece in &run.gaps.pieces {
            let own = (piece.start + half..piece.end.saturating_sub(half)).step_by(stride);
            if own.len() >= LEAST_SAMPLES {
                pieces.push(centres.len()..centres.len() + own.len());
                centres.extend(own);
            }
        }
        let smooth = |column: &Vec<f64>| -> Vec<f64> {
            let one = |i: &usize| {
                let window = column[i - half..=i + half].iter().zip(&weights);
                window.map(|(x, w)| x * w).sum::<f64>() / sum
            };
            centres.iter().map(one).collect()
        };
        let dt_s = stride as f64 * run.dt_s;
        (centres.len() as f64 * dt_s >= LEAST_S).then(|| Slow {
            dt_s,
            channels: COLUMNS.map(|name| run.columns.get(name).map(smooth)),
            pieces,
        })
    }

    pub fn len(&self) -> usize {
        self.pieces.last().map_or(0, |piece| piece.end)
    }

    /// Without the first and the last `reach` samples of each stretch; of one sensor `shift` of
    /// `2 reach` samples later ones.
    fn shifted(&self, sensor: Sensor, reach: usize, shift: usize) -> Slow {
        let long = |piece: &&Range<usize>| piece.len() >= 2 * reach + LEAST_SAMPLES;
        let kept: Vec<&Range<usize>> = self.pieces.iter().filter(long).collect();
        let cut = |at: usize| -> Option<Vec<f64>> {
            let x = self.channels[at].as_ref()?;
            let first = if at == sensor as usize { shift } else { reach };
            let own = |piece: &&Range<usize>| &x[piece.start + first..][..piece.len() - 2 * reach];
            Some(kept.iter().flat_map(own).copied().collect())
        };
        let mut end = 0;
        let piece = |piece: &&Range<usize>| {
            let start = end;
            end += piece.len() - 2 * reach;
            start..end
        };
        Slow {
            dt_s: self.dt_s,
            pieces: kept.iter().map(piece).collect(),
            channels: std::array::from_fn(cut),
        }
    }

    /// Whether all of these are recorded.
    pub fn has(&self, sensors: &[Sensor]) -> bool {
        sensors.iter().all(|sensor| self[*sensor].is_some())
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

    /// The velocity in the axes of the body [m/s]; without a slip sensor it is straight ahead.
    fn velocity(&self) -> Vec<Vector3<f64>> {
        let [v, alpha] = [Sensor::Speed, Sensor::Slip].map(|sensor| self.channel(sensor, 0.0));
        let pairs = v.iter().zip(alpha.iter());
        let velocity = |(v, alpha): (&f64, &f64)| Vector3::new(alpha.cos(), -alpha.sin(), 0.0) * *v;
        pairs.map(velocity).collect()
    }

    /// Samples that are two or more from the ends of their stretch.
    pub fn inner(&self) -> impl Iterator<Item = usize> {
        let pieces = self.pieces.iter();
        pieces.flat_map(|piece| piece.start + 2..piece.end.saturating_sub(2))
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

    /// D x, the rate of a vector as it is seen from outside the turning body.
    pub fn outside_rate(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let turn = self.vectors(Sensor::GYROSCOPE, [0.0; 3]);
        let rates = self.rate(x);
        (0..x.len())
            .map(|i| rates[i] + turn[i].cross(&x[i]))
            .collect()
    }
}

/// Both products of each component of `w x x`.
fn cross_terms(w: Vector3<f64>, x: Vector3<f64>) -> [Vector3<f64>; 2] {
    [
        w.yzx().component_mul(&x.zxy()),
        -w.zxy().component_mul(&x.yzx()),
    ]
}

/// The terms of the relations.
struct Relations {
    /// `da/dt`, those of `-d(D v)/dt` and those of `w x (a - D v)` at each inner sample [m/s3].
    terms: Vec<[Vector3<f64>; 6]>,
    /// `|a - D v|` [m/s2].
    lift: Vec<f64>,
}

impl Relations {
    /// Of the channels; one that is not recorded counts as 0, the vertical accelerometer as gravity.
    fn of(slow: &Slow) -> Relations {
        let force = slow.vectors(Sensor::ACCELEROMETER, [0.0, 0.0, GRAVITY]);
        let turn = slow.vectors(Sensor::GYROSCOPE, [0.0; 3]);
        let velocity = slow.velocity();
        let products = |i: usize| cross_terms(turn[i], velocity[i]).into();
        let (first, second): (Vec<_>, Vec<_>) = (0..slow.len()).map(products).unzip();
        let growth = slow.rate(&velocity);
        let lift = |i: usize| force[i] - growth[i] - first[i] - second[i];
        let rates = [&force, &growth, &first, &second].map(|x| slow.rate(x));
        let terms = |i: usize| {
            let [force, growth, first, second] = [0, 1, 2, 3].map(|part: usize| rates[part][i]);
            let [left, right] = cross_terms(turn[i], lift(i));
            [force, -growth, -first, -second, left, right]
        };
        Relations {
            terms: slow.inner().map(terms).collect(),
            lift: slow.inner().map(|i| lift(i).norm()).collect(),
        }
    }

    fn residuals(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.terms.iter().map(|terms| terms.iter().sum())
    }

    /// Sum of the squares of all terms of each relation.
    fn scale(&self) -> Vector3<f64> {
        let all = self.terms.iter().flatten();
        all.map(|term| term.component_mul(term)).sum()
    }
}

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

impl Agreement {
    /// Of the slow channels of a run.
    pub fn of(slow: &Slow) -> Agreement {
        let relations = Relations::of(slow);
        let residuals = relations.residuals().map(|x| x.component_mul(&x));
        let (residuals, scale) = (residuals.sum::<Vector3<f64>>(), relations.scale());
        let weighed = slow.has(&[Sensor::Az]);
        let turns = slow.has(&[Sensor::RollRate]) || slow.has(&[Sensor::PitchRate]);
        let judged = [
            slow.has(&[Sensor::Ax]),
            slow.has(&[Sensor::Ay]),
            weighed && turns,
        ];
        let least = STILL * relations.terms.len() as f64;
        let residual = |axis: usize| {
            let known = judged[axis] && scale[axis] > least;
            known.then(|| residuals[axis] / scale[axis])
        };
        Agreement {
            residual: [0, 1, 2].map(residual),
            lift: median(relations.lift).filter(|_| weighed),
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

    /// Axis and residual of each relation that can be judged after a change, before and after; NaN
    /// where it could not be judged before.
    pub fn changes(&self, after: &Agreement) -> impl Iterator<Item = (&'static str, f64, f64)> {
        let pairs = self.residual.into_iter().zip(after.residual);
        let pairs = ["x", "y", "z"].into_iter().zip(pairs);
        pairs.filter_map(|(axis, (b, a))| Some((axis, b.unwrap_or(f64::NAN), a?)))
    }

    /// What a correction changes, in words.
    pub fn compared(&self, after: &Agreement) -> String {
        let shown = self.changes(after).filter(|(_, b, a)| (b - a).abs() > 0.02);
        let parts = shown.map(|(axis, b, a)| {
            let [b, a] = [b, a].map(|residual| 100.0 * residual.sqrt());
            format!("{b:.0} % along {axis}, corrected {a:.0} %")
        });
        let parts: Vec<String> = parts.collect();
        let mut text = format!("residual of D (a - D v) = 0: {}", parts.join("; "));
        if let (Some(before), Some(after)) = (self.lift, after.lift)
            && (before - after).abs() > 0.2
        {
            text += &format!("; lift against gravity {before:.1} m/s2, corrected {after:.1}");
        }
        text
    }
}

/// Blocks of time that are left out for standard errors.
const BLOCKS: usize = 20;

/// A coefficient and its standard error.
pub(super) type Coefficient = (f64, f64);

/// Coefficients of columns and a constant for these values, with errors by leaving out a twentieth
/// at a time; `None` where the columns do not determine them.
pub(super) fn coefficients(columns: &[&[f64]], values: &[f64]) -> Option<Vec<Coefficient>> {
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
    let error = |k: usize| {
        let squares: f64 = without.iter().map(|b| (b[k] - all[k]).powi(2)).sum();
        (share * squares).sqrt()
    };
    let found = (0..columns.len()).map(|k| (all[k] / scale[k], error(k) / scale[k]));
    Some(found.collect())
}

/// One over the size of the terms of each relation of a recorded acceleration, 0 of another.
fn weight(slow: &Slow) -> Vector3<f64> {
    let recorded = Vector3::from_fn(|axis, _| f64::from(u8::from(slow.channels[axis].is_some())));
    recorded.zip_map(&Relations::of(slow).scale(), |recorded, scale| {
        recorded / scale.sqrt().max(1e-300)
    })
}

/// The residuals of all relations times their weights, sample by sample.
fn weighted(slow: &Slow, weight: &Vector3<f64>) -> DVector<f64> {
    let relations = Relations::of(slow);
    let residuals = relations.residuals().map(|x| x.component_mul(weight));
    let all: Vec<f64> = residuals.flat_map(|x| [x.x, x.y, x.z]).collect();
    DVector::from_vec(all)
}

/// What an accelerometer or a slip sensor that is not where it is stated to be changes in them, a
/// metre along each axis.
fn places(slow: &Slow, weight: &Vector3<f64>) -> Vec<DVector<f64>> {
    let now = weighted(slow, weight);
    let moved = [0, 1, 2].map(|axis| accelerometer_moved(slow, axis));
    let moved = moved.into_iter().chain(slip_moved(slow));
    let effects = moved.map(|moved| weighted(&moved, weight) - &now);
    effects.filter(|effect| effect.amax() > 0.0).collect()
}

/// How many times the change from `slow` to `changed` the relations require, for changes to which
/// the relations are linear.
///
/// Fitted together with an accelerometer or a slip sensor that is not where it is stated to be.
pub(super) fn required_change(slow: &Slow, changed: &Slow) -> Option<Coefficient> {
    let weight = weight(slow);
    let now = weighted(slow, &weight);
    let mut columns = vec![weighted(changed, &weight) - &now];
    columns.extend(places(slow, &weight));
    let columns: Vec<&[f64]> = columns.iter().map(DVector::as_slice).collect();
    coefficients(&columns, (-now).as_slice())?.first().copied()
}

/// The readings of the accelerometer a metre further along an axis.
fn accelerometer_moved(slow: &Slow, axis: usize) -> Slow {
    let mut moved = slow.clone();
    let place = vec![Vector3::ith(axis, 1.0); slow.len()];
    let more = slow.outside_rate(&slow.outside_rate(&place));
    for (axis, sensor) in Sensor::ACCELEROMETER.into_iter().enumerate() {
        let values = moved[sensor].iter_mut().flatten();
        values.zip(&more).for_each(|(a, more)| *a += more[axis]);
    }
    moved
}

/// The readings of the slip sensor a metre ahead.
fn slip_moved(slow: &Slow) -> Option<Slow> {
    let mut moved = slow.clone();
    let (yaw, v) = (
        slow[Sensor::YawRate].as_ref()?,
        slow[Sensor::Speed].as_ref()?,
    );
    let turn = yaw.iter().zip(v).map(|(r, v)| r / v);
    moved[Sensor::Slip]
        .as_mut()?
        .iter_mut()
        .zip(turn)
        .for_each(|(alpha, turn)| *alpha -= turn);
    Some(moved)
}

/// How late a channel is relative to the others, if it alone is [s], with its standard error.
///
/// The shift of least residual, together with places as in [`required_change`]. The noise of a
/// channel is the same at every shift. It would attenuate a regression on the channel's rate. The
/// error is that of halves of the run. `None` where the least residual of the whole or of a half is
/// at an end of [`MOST_LATE_S`].
///
/// Without a slip sensor the slip's own part of the lateral force would pass for a delay of it:
/// there is none.
pub(super) fn delay(slow: &Slow, sensor: Sensor) -> Option<Coefficient> {
    let related = sensor as usize <= Sensor::Slip as usize;
    if !related || !slow.has(&[sensor]) || sensor == Sensor::Ay && !slow.has(&[Sensor::Slip]) {
        return None;
    }
    let reach = (MOST_LATE_S / slow.dt_s).round() as usize;
    let centred = slow.shifted(sensor, reach, reach);
    if centred.len() == 0 {
        return None;
    }
    let weight = weight(&centred);
    // Sums of squares by shift and block.
    let squares = |shift: usize| {
        let shifted = slow.shifted(sensor, reach, shift);
        let residual = weighted(&shifted, &weight);
        let count = residual.len();
        let mut columns = places(&shifted, &weight);
        columns.push(DVector::repeat(count, 1.0));
        let basis = DMatrix::from_columns(&columns).qr().q();
        let rest = &residual - &basis * basis.tr_mul(&residual);
        let mut sums = [0.0; BLOCKS];
        for (i, x) in rest.iter().enumerate() {
            sums[i * BLOCKS / count] += x * x;
        }
        sums
    };
    let squares: Vec<[f64; BLOCKS]> = (0..=2 * reach).map(squares).collect();
    let least = |blocks: &dyn Fn(usize) -> bool| {
        let sum = |sums: &[f64; BLOCKS]| -> f64 {
            let sums = sums.iter().enumerate();
            sums.filter(|(block, _)| blocks(*block))
                .map(|(_, sum)| sum)
                .sum()
        };
        let sums: Vec<f64> = squares.iter().map(sum).collect();
        let best = (0..sums.len()).min_by(|a, b| sums[*a].total_cmp(&sums[*b]))?;
        let (before, after) = (sums.get(best.wrapping_sub(1))?, sums.get(best + 1)?);
        // The vertex of the parabola through the least and its neighbours.
        let vertex = 0.5 * (before - after) / (before - 2.0 * sums[best] + after);
        Some((best as f64 - reach as f64 + vertex) * slow.dt_s)
    };
    let all = least(&|_| true)?;
    // Of a half, the deviation from the whole has the variance of the whole.
    let half = |first: usize| least(&|block| (block + first) % BLOCKS < BLOCKS / 2);
    let halves: Vec<f64> = (0..BLOCKS).map(half).collect::<Option<_>>()?;
    Some((all, root_mean_square(halves.iter().map(|half| half - all))))
}
