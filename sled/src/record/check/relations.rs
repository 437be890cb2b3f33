//! Relations between the channels of one rigid body.
//!
//! The specific force `a` less the acceleration of the motion is opposite to gravity, which is
//! constant in size and direction. In the axes of the body, with the rotation rates `w` and the speed
//! `v` at the slip angle `alpha`:
//!
//! ```text
//! D (a - D v) = 0,   |a - D v| = g,   D x = dx/dt + w x x,   v = (v cos(alpha), -v sin(alpha), 0)
//! ```
//!
//! The measure of each component of the first relation is its residual over the sum of its terms,
//! both as mean squares: near 0 if all channels are right, 1 if nothing cancels. In 44 simulated runs
//! of a bobsled, with its accelerometer 0.37 m off, it is below 0.1, 0.03 and 0.01 for x, y and z. In
//! runs of a real car it is below 0.06 and 0.05 for x and y.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::{Div, Index, IndexMut, Range, Sub};

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use crate::column::{COLUMNS, SENSORS, Sensor};
use crate::friction::GRAVITY;
use crate::record::run::Run;
use crate::series::{median, root_mean_square};

/// Corner of the low pass [Hz].
const CORNER_HZ: f64 = 1.0;
/// Rate of the low-passed channels [Hz].
const RATE_HZ: f64 = 20.0;
/// Fewest samples of a stretch: derivatives use two at each end.
const MIN_SAMPLES: usize = 9;
/// Largest delay that is searched [s].
const MAX_DELAY_S: f64 = 1.0;
/// Shortest duration of the channels [s].
const MIN_DURATION_S: f64 = 5.0;

/// Channels of a run, low-passed at 1 Hz.
#[derive(Clone, Debug)]
pub(super) struct SlowChannels {
    /// Time between samples [s].
    pub dt_s: f64,
    /// The channels in the order of [`COLUMNS`]; `None` for one that is not recorded.
    pub channels: [Option<Vec<f64>>; SENSORS],
    /// Stretches without a gap.
    pieces: Vec<Range<usize>>,
}

impl Index<Sensor> for SlowChannels {
    type Output = Option<Vec<f64>>;

    fn index(&self, of: Sensor) -> &Option<Vec<f64>> {
        &self.channels[of as usize]
    }
}

impl IndexMut<Sensor> for SlowChannels {
    fn index_mut(&mut self, of: Sensor) -> &mut Option<Vec<f64>> {
        &mut self.channels[of as usize]
    }
}

impl SlowChannels {
    /// The channels of a run after a Gaussian low pass; `None` if they last less than 5 s.
    pub fn of(run: &Run) -> Option<SlowChannels> {
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
            if own.len() >= MIN_SAMPLES {
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
        (centres.len() as f64 * dt_s >= MIN_DURATION_S).then(|| SlowChannels {
            dt_s,
            channels: COLUMNS.map(|name| run.columns.get(name).map(smooth)),
            pieces,
        })
    }

    pub fn len(&self) -> usize {
        self.pieces.last().map_or(0, |piece| piece.end)
    }

    /// The channels without the first and the last `reach` samples of each stretch. The channel of
    /// `sensor` is advanced by `shift - reach` samples, with `shift` from 0 to `2 reach`.
    fn shifted(&self, sensor: Sensor, reach: usize, shift: usize) -> SlowChannels {
        let is_long = |piece: &&Range<usize>| piece.len() >= 2 * reach + MIN_SAMPLES;
        let long: Vec<&Range<usize>> = self.pieces.iter().filter(is_long).collect();
        let cut = |at: usize| -> Option<Vec<f64>> {
            let x = self.channels[at].as_ref()?;
            let first = if at == sensor as usize { shift } else { reach };
            let own = |piece: &&Range<usize>| &x[piece.start + first..][..piece.len() - 2 * reach];
            Some(long.iter().flat_map(own).copied().collect())
        };
        let mut end = 0;
        let piece = |piece: &&Range<usize>| {
            let start = end;
            end += piece.len() - 2 * reach;
            start..end
        };
        SlowChannels {
            dt_s: self.dt_s,
            pieces: long.iter().map(piece).collect(),
            channels: std::array::from_fn(cut),
        }
    }

    /// Whether all of these are recorded.
    pub fn has(&self, sensors: &[Sensor]) -> bool {
        sensors.iter().all(|sensor| self[*sensor].is_some())
    }

    /// Whether all axes of the accelerometer and of the gyroscope are recorded.
    pub fn has_box(&self) -> bool {
        self.has(&Sensor::ACCELEROMETER) && self.has(&Sensor::GYROSCOPE)
    }

    /// The channels with accelerometer and gyroscope rotated.
    pub fn rotated(&self, rotation: &Rotation3<f64>) -> SlowChannels {
        let mut rotated = self.clone();
        for axes in [Sensor::ACCELEROMETER, Sensor::GYROSCOPE] {
            for (i, own) in self.vectors(axes, [0.0; 3]).iter().enumerate() {
                for (sensor, x) in axes.iter().zip(&(rotation * own)) {
                    if let Some(values) = &mut rotated[*sensor] {
                        values[i] = *x;
                    }
                }
            }
        }
        rotated
    }

    /// A channel; the value `absent` throughout if it is not recorded.
    fn channel(&self, sensor: Sensor, absent: f64) -> Cow<'_, [f64]> {
        match &self[sensor] {
            Some(x) => x.into(),
            None => vec![absent; self.len()].into(),
        }
    }

    /// A vector at every sample, from the sensors of its axes and their values if not recorded.
    pub fn vectors(&self, axes: [Sensor; 3], absent: [f64; 3]) -> Vec<Vector3<f64>> {
        let axes: [_; 3] = std::array::from_fn(|axis| self.channel(axes[axis], absent[axis]));
        let vector = |i: usize| Vector3::from_fn(|axis, _| axes[axis][i]);
        (0..self.len()).map(vector).collect()
    }

    /// Velocity in the axes of the body [m/s]; straight ahead without a slip sensor.
    fn velocity(&self) -> Vec<Vector3<f64>> {
        let [v, alpha] = [Sensor::Speed, Sensor::Slip].map(|sensor| self.channel(sensor, 0.0));
        let pairs = v.iter().zip(alpha.iter());
        let velocity = |(v, alpha): (&f64, &f64)| Vector3::new(alpha.cos(), -alpha.sin(), 0.0) * *v;
        pairs.map(velocity).collect()
    }

    /// Samples at least two from the ends of their stretch.
    pub fn inner(&self) -> impl Iterator<Item = usize> {
        let pieces = self.pieces.iter();
        pieces.flat_map(|piece| piece.start + 2..piece.end.saturating_sub(2))
    }

    /// Time derivative by central differences in each stretch, one-sided at its ends.
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

    /// D x = dx/dt + w x x, the rate of a vector in the inertial frame.
    pub fn inertial_rate(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let turn = self.vectors(Sensor::GYROSCOPE, [0.0; 3]);
        let rates = self.rate(x);
        (0..x.len())
            .map(|i| rates[i] + turn[i].cross(&x[i]))
            .collect()
    }
}

/// The two products in each component of `w x x`.
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
    gravity: Vec<f64>,
}

impl Relations {
    /// A channel that is not recorded is 0, a vertical accelerometer that is not is gravity.
    fn of(slow: &SlowChannels) -> Relations {
        let force = slow.vectors(Sensor::ACCELEROMETER, [0.0, 0.0, GRAVITY]);
        let turn = slow.vectors(Sensor::GYROSCOPE, [0.0; 3]);
        let velocity = slow.velocity();
        let products = |i: usize| cross_terms(turn[i], velocity[i]).into();
        let (first, second): (Vec<_>, Vec<_>) = (0..slow.len()).map(products).unzip();
        let acceleration = slow.rate(&velocity);
        // a - D v, opposite to gravity.
        let gravity = |i: usize| force[i] - acceleration[i] - first[i] - second[i];
        let rates = [&force, &acceleration, &first, &second].map(|x| slow.rate(x));
        let terms = |i: usize| {
            let [force, acceleration, first, second] = rates.each_ref().map(|rate| rate[i]);
            let [plus, minus] = cross_terms(turn[i], gravity(i));
            [force, -acceleration, -first, -second, plus, minus]
        };
        Relations {
            terms: slow.inner().map(terms).collect(),
            gravity: slow.inner().map(|i| gravity(i).norm()).collect(),
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

/// Mean square of the terms [m2/s6] below which the sled moves too little for a residual.
const MIN_MEAN_SQUARE: f64 = 1e-3;
/// Residual that noise and the places of the sensors explain.
const RESIDUAL_FLOOR: f64 = 0.01;
/// Relative deviation of `|a - D v|` from gravity that the places of the sensors explain.
const GRAVITY_TOLERANCE: f64 = 0.1;

/// How well the channels of a run satisfy the relations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Consistency {
    /// Residual of each relation over its terms, mean squares; `None` if the channels do not
    /// determine it.
    pub residual: [Option<f64>; 3],
    /// Median of `|a - D v|` [m/s2]; `None` without a vertical accelerometer.
    pub gravity: Option<f64>,
}

impl Consistency {
    pub fn of(slow: &SlowChannels) -> Consistency {
        let relations = Relations::of(slow);
        let residuals = relations.residuals().map(|x| x.component_mul(&x));
        let (residuals, scale) = (residuals.sum::<Vector3<f64>>(), relations.scale());
        let has_az = slow.has(&[Sensor::Az]);
        let has_tilt = slow.has(&[Sensor::RollRate]) || slow.has(&[Sensor::PitchRate]);
        let is_recorded = [
            slow.has(&[Sensor::Ax]),
            slow.has(&[Sensor::Ay]),
            has_az && has_tilt,
        ];
        let min_scale = MIN_MEAN_SQUARE * relations.terms.len() as f64;
        let residual = |axis: usize| {
            let is_known = is_recorded[axis] && scale[axis] > min_scale;
            is_known.then(|| residuals[axis] / scale[axis])
        };
        Consistency {
            residual: [0, 1, 2].map(residual),
            gravity: median(relations.gravity).filter(|_| has_az),
        }
    }

    /// Whether the known residuals of the lateral and the vertical relation are below a limit.
    pub fn is_below(&self, limit: f64) -> bool {
        let mut known = self.residual[1..].iter().flatten();
        known.all(|residual| *residual < limit)
    }

    /// Sum of the logarithms of the residuals, so that a factor in any relation has the same
    /// weight, and of the deviation from gravity; lower is better.
    pub fn disagreement(&self) -> f64 {
        let known = self.residual.iter().flatten();
        let sum: f64 = known.map(|residual| (residual + RESIDUAL_FLOOR).ln()).sum();
        let deviation = |gravity: f64| (gravity / GRAVITY).ln() / GRAVITY_TOLERANCE;
        let squared = |gravity: f64| deviation(gravity).powi(2).min(10.0);
        sum + self.gravity.map_or(0.0, squared)
    }

    /// Axis, residual before (NaN if unknown) and residual after, for each relation with a known
    /// residual after.
    pub fn changes(&self, after: &Consistency) -> impl Iterator<Item = (&'static str, f64, f64)> {
        let pairs = self.residual.into_iter().zip(after.residual);
        let pairs = ["x", "y", "z"].into_iter().zip(pairs);
        pairs.filter_map(|(axis, (b, a))| Some((axis, b.unwrap_or(f64::NAN), a?)))
    }

    /// The change of the residuals by a correction, in words.
    pub fn describe_change(&self, after: &Consistency) -> String {
        let shown = self.changes(after).filter(|(_, b, a)| (b - a).abs() > 0.02);
        let parts = shown.map(|(axis, b, a)| {
            let [b, a] = [b, a].map(|residual| 100.0 * residual.sqrt());
            format!("{b:.0} % along {axis}, corrected {a:.0} %")
        });
        let parts: Vec<String> = parts.collect();
        let mut text = format!("residual of D (a - D v) = 0: {}", parts.join("; "));
        if let (Some(before), Some(after)) = (self.gravity, after.gravity)
            && (before - after).abs() > 0.2
        {
            text += &format!("; lift against gravity {before:.1} m/s2, corrected {after:.1}");
        }
        text
    }
}

/// Blocks of time of the jackknife for standard errors.
const BLOCKS: usize = 20;

/// A coefficient and its standard error.
pub(super) type Coefficient = (f64, f64);

/// Least squares coefficients of the columns, fitted to the values together with a constant, with
/// jackknife errors over [`BLOCKS`]; `None` if the columns do not determine them.
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

/// Weight of each relation: one over the root of the sum of its squared terms; 0 if its
/// acceleration is not recorded.
fn weight(slow: &SlowChannels) -> Vector3<f64> {
    let recorded = Vector3::from_fn(|axis, _| f64::from(u8::from(slow.channels[axis].is_some())));
    recorded.zip_map(&Relations::of(slow).scale(), |recorded, scale| {
        recorded / scale.sqrt().max(1e-300)
    })
}

/// The weighted residuals of all relations, sample by sample.
fn weighted(slow: &SlowChannels, weight: &Vector3<f64>) -> DVector<f64> {
    let relations = Relations::of(slow);
    let residuals = relations.residuals().map(|x| x.component_mul(weight));
    let all: Vec<f64> = residuals.flat_map(|x| [x.x, x.y, x.z]).collect();
    DVector::from_vec(all)
}

/// Change of the weighted residuals if the accelerometer is displaced by a metre along each axis,
/// and if the slip sensor is displaced by a metre ahead.
fn displacement_effects(slow: &SlowChannels, weight: &Vector3<f64>) -> Vec<DVector<f64>> {
    let now = weighted(slow, weight);
    let displaced = [0, 1, 2].map(|axis| displace_accelerometer(slow, axis));
    let displaced = displaced.into_iter().chain(displace_slip_sensor(slow));
    let effects = displaced.map(|displaced| weighted(&displaced, weight) - &now);
    effects.filter(|effect| effect.amax() > 0.0).collect()
}

/// Change of the weighted residuals by a small rotation of the sensor box about each axis; none
/// unless all its channels are recorded.
fn rotation_effects(slow: &SlowChannels, weight: &Vector3<f64>) -> Vec<DVector<f64>> {
    const STEP_RAD: f64 = 1e-3;
    if !slow.has_box() {
        return Vec::new();
    }
    let now = weighted(slow, weight);
    let effect = |axis| {
        let rotation = Rotation3::new(Vector3::ith(axis, STEP_RAD));
        weighted(&slow.rotated(&rotation), weight) - &now
    };
    [0, 1, 2].map(effect).into()
}

/// Multiple of the change from `slow` to `changed` that minimises the residuals, for a change in
/// which the relations are linear.
///
/// It is fitted together with displacements of the accelerometer and of the slip sensor.
pub(super) fn required_change(slow: &SlowChannels, changed: &SlowChannels) -> Option<Coefficient> {
    let weight = weight(slow);
    let now = weighted(slow, &weight);
    let mut columns = vec![weighted(changed, &weight) - &now];
    columns.extend(displacement_effects(slow, &weight));
    let columns: Vec<&[f64]> = columns.iter().map(DVector::as_slice).collect();
    coefficients(&columns, (-now).as_slice())?.first().copied()
}

/// The channels with the accelerometer displaced by a metre along an axis: `a + D D x`.
fn displace_accelerometer(slow: &SlowChannels, axis: usize) -> SlowChannels {
    let mut displaced = slow.clone();
    let place = vec![Vector3::ith(axis, 1.0); slow.len()];
    let added = slow.inertial_rate(&slow.inertial_rate(&place));
    for (axis, sensor) in Sensor::ACCELEROMETER.into_iter().enumerate() {
        let values = displaced[sensor].iter_mut().flatten();
        values.zip(&added).for_each(|(a, added)| *a += added[axis]);
    }
    displaced
}

/// The channels with the slip sensor displaced by a metre ahead: `alpha - r / v`.
fn displace_slip_sensor(slow: &SlowChannels) -> Option<SlowChannels> {
    let mut displaced = slow.clone();
    let yaw = slow[Sensor::YawRate].as_ref()?;
    let v = slow[Sensor::Speed].as_ref()?;
    let slips = displaced[Sensor::Slip].as_mut()?;
    for ((alpha, r), v) in slips.iter_mut().zip(yaw).zip(v) {
        *alpha -= r / v;
    }
    Some(displaced)
}

/// Delay of one channel relative to all others, and its standard error [s].
///
/// The delay is the shift of least residual, fitted together with displacements as in
/// [`required_change`]. The noise of a channel is the same at every shift, whereas it would attenuate
/// a regression on the channel's rate. The error is that of halves of the run, and the change of the
/// delay if a small rotation of the sensor box is fitted, too: it would appear as delays of some of
/// its channels.
///
/// `None` for a channel without a relation, for the lateral acceleration without a slip sensor (the
/// lateral force due to slip would appear as a delay), and if the least residual of the run or of a
/// half is at an end of the range of [`MAX_DELAY_S`].
pub(super) fn delay(slow: &SlowChannels, sensor: Sensor) -> Option<Coefficient> {
    let is_related = sensor as usize <= Sensor::Slip as usize;
    if !is_related || !slow.has(&[sensor]) || sensor == Sensor::Ay && !slow.has(&[Sensor::Slip]) {
        return None;
    }
    let reach = (MAX_DELAY_S / slow.dt_s).round() as usize;
    let centred = slow.shifted(sensor, reach, reach);
    if centred.len() == 0 {
        return None;
    }
    let weight = weight(&centred);
    // Sums of squared residuals by shift and block, and their sum if a rotation is fitted, too.
    let squares = |shift: usize| {
        let shifted = slow.shifted(sensor, reach, shift);
        let residual = weighted(&shifted, &weight);
        let count = residual.len();
        let mut columns = displacement_effects(&shifted, &weight);
        columns.push(DVector::repeat(count, 1.0));
        let rest = |columns: &[DVector<f64>]| {
            let basis = DMatrix::from_columns(columns).qr().q();
            &residual - &basis * basis.tr_mul(&residual)
        };
        let mut sums = [0.0; BLOCKS];
        for (i, x) in rest(&columns).iter().enumerate() {
            sums[i * BLOCKS / count] += x * x;
        }
        columns.extend(rotation_effects(&shifted, &weight));
        (sums, rest(&columns).norm_squared())
    };
    let (squares, rotated): (Vec<[f64; BLOCKS]>, Vec<f64>) = (0..=2 * reach).map(squares).unzip();
    let least = |sums: &[f64]| {
        let best = (0..sums.len()).min_by(|a, b| sums[*a].total_cmp(&sums[*b]))?;
        let (before, after) = (sums.get(best.wrapping_sub(1))?, sums.get(best + 1)?);
        // The vertex of the parabola through the least and its neighbours.
        let vertex = 0.5 * (before - after) / (before - 2.0 * sums[best] + after);
        Some((best as f64 - reach as f64 + vertex) * slow.dt_s)
    };
    let best_delay = |is_used: &dyn Fn(usize) -> bool| {
        let sum = |sums: &[f64; BLOCKS]| -> f64 {
            let used = sums.iter().enumerate().filter(|(block, _)| is_used(*block));
            used.map(|(_, sum)| sum).sum()
        };
        least(&squares.iter().map(sum).collect::<Vec<f64>>())
    };
    let all = best_delay(&|_| true)?;
    // The difference between a half and the whole has the variance of the whole.
    let half = |first: usize| best_delay(&|block| (block + first) % BLOCKS < BLOCKS / 2);
    let halves: Vec<f64> = (0..BLOCKS).map(half).collect::<Option<_>>()?;
    let error = root_mean_square(halves.iter().map(|half| half - all));
    Some((all, error.hypot(least(&rotated)? - all)))
}
