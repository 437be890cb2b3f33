//! Curvature, bank and slope of the track as measured by a run, metre by metre of its own distance.

use crate::motion::state::State;
use crate::series::{HALF_WIDTH, derivative};
use crate::signals::prepare::Prepared;
use crate::sled::Sled;
use crate::track::table::TrackShape;

/// Half width of the mean of the slope [m]. The slope depends on the derivative of the speed, whose
/// noise falls with the length of the mean, and varies over tens of metres.
const SLOPE_HALF_WIDTH_M: usize = 3;

/// Curvature [1/m], bank and slope [rad] at every metre of a run's own distance.
#[derive(Clone, Debug)]
pub(crate) struct TrackSignature {
    /// The first metre [m].
    pub from_m: f64,
    /// Means over each metre; NaN for a metre without samples.
    pub metres: Vec<[f64; 3]>,
}

impl TrackSignature {
    /// The signature of a run. Slope and bank are the angles of the upward direction u, which
    /// follows from the specific force f at the centre of gravity and the measured motion, without
    /// a law of friction:
    ///
    /// ```text
    /// g u_x = f_x + r v_y - dv_x/dt      g u_y = f_y - r v_x - dv_y/dt      g u_z = f_z - p v_y + q v_x
    /// u_t = (u_x v_x + u_y v_y)/v        u_n = (u_y v_x - u_x v_y)/v
    /// slope = atan2(-u_t, |u_n, u_z|)    bank = atan2(u_n, u_z)             curvature = (p v_y - q v_x)/v^2
    /// ```
    ///
    /// with roll, pitch and yaw rate (p, q, r) and `v_z = 0`: the body moves on the ice.
    pub(crate) fn of(run: &Prepared, sled: &Sled) -> TrackSignature {
        let from_m = run.states[0].s_m.round();
        let places = run.states.iter().map(|state| state.s_m);
        let last = places.fold(from_m, f64::max);
        let count = (last - from_m).round() as usize + 1;
        // Curvature, g u and the number of samples.
        let mut sums = vec![[0.0; 5]; count];
        for piece in run.pieces.iter().filter(|p| p.len() > 2 * HALF_WIDTH) {
            let states = &run.states[piece.clone()];
            let velocity = |state: &State| {
                let turn = state.yaw_rate_radps / state.v_mps;
                let alpha = state.alpha_cog_rad - turn * sled.slip_x_m;
                let (sine, cosine) = alpha.sin_cos();
                let across = -state.v_mps * sine - sled.slip_x_m * state.yaw_rate_radps;
                [state.v_mps * cosine, across]
            };
            let velocity: Vec<[f64; 2]> = states.iter().map(velocity).collect();
            let velocity_rate = [0, 1].map(|k| {
                let component: Vec<f64> = velocity.iter().map(|v| v[k]).collect();
                derivative(&component, run.dt_s)
            });
            for (i, state) in states.iter().enumerate() {
                let place = (state.s_m - from_m).round();
                if !(0.0..count as f64).contains(&place) {
                    continue;
                }
                let f = &run.motions[piece.start + i].accel_mps2;
                let [vx, vy] = velocity[i];
                let v = vx.hypot(vy);
                let up_x = f[0] + state.yaw_rate_radps * vy - velocity_rate[0][i];
                let up_y = f[1] - state.yaw_rate_radps * vx - velocity_rate[1][i];
                let turn = state.roll_rate_radps * vy - state.pitch_rate_radps * vx;
                let sum = &mut sums[place as usize];
                sum[0] += turn / (v * v);
                sum[1] += (up_x * vx + up_y * vy) / v;
                sum[2] += (up_y * vx - up_x * vy) / v;
                sum[3] += f[2] - turn;
                sum[4] += 1.0;
            }
        }
        let mean = |i: usize| {
            let [curvature, _, y, z, count] = sums[i];
            if count == 0.0 {
                return [f64::NAN; 3];
            }
            let about = &sums
                [i.saturating_sub(SLOPE_HALF_WIDTH_M)..sums.len().min(i + SLOPE_HALF_WIDTH_M + 1)];
            let (x, all) = about
                .iter()
                .fold((0.0, 0.0), |(x, n), at| (x + at[1], n + at[4]));
            let slope = (-x / all).atan2(y.hypot(z) / count);
            [curvature / count, y.atan2(z), slope]
        };
        let metres = (0..count).map(mean).collect();
        TrackSignature { from_m, metres }
    }

    /// Own distance of metre `i` [m].
    pub(crate) fn place(&self, i: usize) -> f64 {
        self.from_m + i as f64
    }
}

/// Curvature [1/m] and bank [rad] of a track at every metre.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceProfile {
    /// The first metre [m].
    pub from_m: f64,
    /// Curvature and bank at each metre; NaN where unknown.
    pub metres: Vec<[f64; 2]>,
    /// Standard deviations of curvature and bank along the track.
    pub spread: [f64; 2],
}

impl ReferenceProfile {
    /// The profile of values at every metre.
    pub(crate) fn new(from_m: f64, metres: Vec<[f64; 2]>) -> ReferenceProfile {
        let spread = [0, 1].map(|k| {
            let values = metres.iter().map(|at| at[k]).filter(|x| x.is_finite());
            let count = values.clone().count().max(1) as f64;
            let mean = values.clone().sum::<f64>() / count;
            let variance = values.map(|x| (x - mean).powi(2)).sum::<f64>() / count;
            variance.sqrt().max(f64::MIN_POSITIVE)
        });
        ReferenceProfile {
            from_m,
            metres,
            spread,
        }
    }

    /// The profile of a surveyed track.
    pub(crate) fn of(shape: &TrackShape) -> ReferenceProfile {
        let count = (shape.finish_m - shape.start_m) as usize + 1;
        let at = |i: usize| {
            let s = shape.start_m + i as f64;
            [shape.curvature.value(s), shape.bank.value(s)]
        };
        ReferenceProfile::new(shape.start_m, (0..count).map(at).collect())
    }

    /// Curvature and bank at the distance `s` [m], linear between metres, and their derivatives;
    /// `None` outside the ends and where one is unknown.
    pub(crate) fn at(&self, s: f64) -> Option<([f64; 2], [f64; 2])> {
        let along = s - self.from_m;
        if along < 0.0 {
            return None;
        }
        let i = along as usize;
        let (a, b) = (self.metres.get(i)?, self.metres.get(i + 1)?);
        let slope = [b[0] - a[0], b[1] - a[1]];
        let share = along - i as f64;
        let value = [a[0] + share * slope[0], a[1] + share * slope[1]];
        let known = value.iter().all(|x| x.is_finite());
        known.then_some((value, slope))
    }
}

/// Map from a run's own distance to the distance along the track: a shift that is linear between
/// knots and constant outside them.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceWarp {
    /// Own distance of each knot [m], increasing.
    pub own_m: Vec<f64>,
    /// Shift of each knot [m].
    pub shift_m: Vec<f64>,
    /// Standard error of the shift [m].
    pub sd_m: Vec<f64>,
}

impl DistanceWarp {
    /// The knot before an own distance, and the weight of the next knot.
    pub(crate) fn between(&self, own: f64) -> (usize, f64) {
        let last = self.own_m.len() - 1;
        let after = self.own_m.partition_point(|knot| *knot <= own);
        let i = after.clamp(1, last) - 1;
        let share = (own - self.own_m[i]) / (self.own_m[i + 1] - self.own_m[i]);
        (i, share.clamp(0.0, 1.0))
    }

    /// The distance along the track [m] of an own distance [m].
    pub fn at(&self, own: f64) -> f64 {
        let (i, share) = self.between(own);
        own + self.shift_m[i] + share * (self.shift_m[i + 1] - self.shift_m[i])
    }

    /// Mean ratio of increments of the distance along the track to those of the own distance.
    pub fn stretch(&self) -> f64 {
        let last = self.own_m.len() - 1;
        let way = self.own_m[last] - self.own_m[0];
        1.0 + (self.shift_m[last] - self.shift_m[0]) / way
    }
}

/// A straight line from the own distance to the distance along the track, with its misfit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Shift at the run's first metre [m].
    pub shift_m: f64,
    /// Ratio of increments of the distance along the track to those of the own distance.
    pub stretch: f64,
    /// Mean squared difference relative to the variance, averaged over curvature and bank.
    pub misfit: f64,
}

/// Step of the trial shifts [m], well within the width of a curve's entry.
const STEP_M: f64 = 2.0;
/// Stride of the compared metres.
const STRIDE: usize = 4;
/// Trial stretches: a wheel or an optical sensor is within 2 %.
const STRETCHES: [f64; 9] = [0.98, 0.985, 0.99, 0.995, 1.0, 1.005, 1.01, 1.015, 1.02];
/// Smallest overlap, as a share of the shorter of run and track.
const MIN_OVERLAP: f64 = 0.6;
/// Smallest distance to a place that counts as another one [m].
const MIN_SEPARATION_M: f64 = 15.0;

/// The best line, and the misfit of the best line at another place; `None` without sufficient
/// overlap.
pub(crate) fn search(
    measured: &TrackSignature,
    reference: &ReferenceProfile,
) -> Option<(Line, f64)> {
    let length = measured.metres.len().min(reference.metres.len());
    let min_count = (MIN_OVERLAP * length as f64 / STRIDE as f64) as usize;
    let base = reference.from_m - measured.from_m;
    let max_shift = (1.0 - MIN_OVERLAP) * length as f64
        + (reference.metres.len() as f64 - measured.metres.len() as f64).abs();
    let count = (2.0 * max_shift / STEP_M) as usize + 1;
    let mut tried: Vec<Line> = Vec::new();
    for stretch in STRETCHES {
        for i in 0..count {
            let shift_m = base - max_shift + i as f64 * STEP_M;
            let misfit = misfit(measured, reference, shift_m, stretch, min_count);
            tried.extend(misfit.map(|misfit| Line {
                shift_m,
                stretch,
                misfit,
            }));
        }
    }
    let best = *tried.iter().min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
    let middle = 0.5 * measured.metres.len() as f64;
    let place = |line: &Line| line.shift_m + line.stretch * middle;
    let is_elsewhere = |line: &&Line| (place(line) - place(&best)).abs() > MIN_SEPARATION_M;
    let elsewhere = tried.iter().filter(is_elsewhere).map(|line| line.misfit);
    Some((best, elsewhere.fold(f64::INFINITY, f64::min)))
}

fn misfit(
    measured: &TrackSignature,
    reference: &ReferenceProfile,
    shift: f64,
    stretch: f64,
    min_count: usize,
) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0);
    for i in (0..measured.metres.len()).step_by(STRIDE) {
        let s = measured.from_m + shift + stretch * i as f64;
        if let Some((at, _)) = reference
            .at(s)
            .filter(|_| measured.metres[i][0].is_finite())
        {
            for ((measured, at), spread) in measured.metres[i].iter().zip(at).zip(reference.spread)
            {
                sum += 0.5 * ((measured - at) / spread).powi(2);
            }
            count += 1;
        }
    }
    (count >= min_count.max(1)).then(|| sum / count as f64)
}
