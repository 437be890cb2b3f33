//! The measurement chain: sensors at their places, their faults, and noise in every channel.

use crate::world::drive::{SAMPLE_S, Truth};
use crate::world::hidden::{Hidden, Kind};
use crate::world::noise::{Ar1, Source};
use crate::world::sled::Sled;

/// Standard deviations of the sensors.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Noise {
    /// Accelerations, vibration included [m/s2].
    pub accel_mps2: f64,
    /// Rates [rad/s].
    pub rate_radps: f64,
    /// Speed [m/s].
    pub speed_mps: f64,
    /// Slip [rad].
    pub slip_rad: f64,
    /// Steering [rad].
    pub steer_rad: f64,
    /// Roll-split [rad].
    pub roll_split_rad: f64,
    /// Correlation of the vibration from sample to sample; 0 is white.
    #[serde(skip)]
    pub colour: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            accel_mps2: 0.05,
            rate_radps: 0.0015,
            speed_mps: 0.03,
            slip_rad: 0.0005,
            steer_rad: 0.0004,
            roll_split_rad: 0.0004,
            colour: 0.6,
        }
    }
}

impl Noise {
    /// Sensors `factor` times as noisy.
    pub fn times(self, factor: f64) -> Self {
        Self {
            accel_mps2: factor * self.accel_mps2,
            rate_radps: factor * self.rate_radps,
            speed_mps: factor * self.speed_mps,
            slip_rad: factor * self.slip_rad,
            steer_rad: factor * self.steer_rad,
            roll_split_rad: factor * self.roll_split_rad,
            colour: self.colour,
        }
    }

    /// No noise at all.
    pub fn none() -> Self {
        Self {
            accel_mps2: 0.0,
            rate_radps: 0.0,
            speed_mps: 0.0,
            slip_rad: 0.0,
            steer_rad: 0.0,
            roll_split_rad: 0.0,
            colour: 0.0,
        }
    }
}

/// What the sensors recorded at one sample.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample {
    /// Time [s].
    pub t_s: f64,
    /// Specific force at the accelerometer [m/s2].
    pub accel_mps2: [f64; 3],
    /// Roll, pitch and yaw rates [rad/s].
    pub rates_radps: [f64; 3],
    /// Speed [m/s].
    pub v_mps: f64,
    /// Slip angle at the slip sensor [rad].
    pub alpha_rad: f64,
    /// Steering [rad].
    pub delta_rad: f64,
    /// Roll-split [rad].
    pub gamma_rad: f64,
    /// The extra channel.
    pub extra: f64,
}

/// Passes the true motion through the sensors.
///
/// Accelerometer: `f = f_cog + omega' x l + omega x (omega x l)` at its place `l`; slip sensor:
/// `alpha = -atan2(v_y + r x_s, v_x)`.
pub fn measure(
    sled: &Sled,
    truths: &[Truth],
    noise: &Noise,
    hidden: &[Hidden],
    source: &mut Source,
) -> Vec<Sample> {
    let size = |kind: Kind| {
        hidden
            .iter()
            .find(|e| e.kind == kind)
            .map_or(0.0, |e| e.size)
    };
    let place = [
        sled.accel_m[0] + size(Kind::LeverArm),
        sled.accel_m[1],
        sled.accel_m[2],
    ];
    let pitch_tilt = size(Kind::AccelerometerTiltPitch);
    let roll_tilt = size(Kind::AccelerometerTiltRoll);
    let mut vibration: Vec<Ar1> = (0..3)
        .map(|_| Ar1::new(noise.colour, noise.accel_mps2, source))
        .collect();
    // Every channel except the accelerations, late by its own time.
    let late = |value: &dyn Fn(&Truth) -> f64, lag: Kind| -> Vec<f64> {
        let values: Vec<f64> = truths.iter().map(value).collect();
        delayed(&values, size(lag) / SAMPLE_S)
    };
    let slip = |truth: &Truth| {
        let [vx, vy] = truth.velocity_mps;
        -(vy + truth.rates_radps[2] * sled.slip_x_m).atan2(vx)
    };
    let turns = [Kind::RollRateLag, Kind::PitchRateLag, Kind::YawRateLag];
    let rates = [0, 1, 2].map(|k| late(&|truth| truth.rates_radps[k], turns[k]));
    let speed = late(&|truth| truth.motion.v_mps, Kind::SpeedLag);
    let shown = late(&slip, Kind::SlipLag);
    let steered = late(&|truth| truth.motion.delta_rad, Kind::SteerLag);
    let split = late(&|truth| truth.motion.gamma_rad, Kind::RollSplitLag);
    let off = |value: f64, scale: Kind, bias: Kind| value * (1.0 + size(scale)) + size(bias);
    truths
        .iter()
        .enumerate()
        .map(|(i, truth)| {
            let [p, q, r] = truth.rates_radps;
            let [pd, qd, rd] = truth.angular_radps2;
            let [x, y, z] = place;
            let f = truth.specific_mps2;
            let clean = [
                f[0] - (q * q + r * r) * x + (p * q - rd) * y + (p * r + qd) * z,
                f[1] + (p * q + rd) * x - (p * p + r * r) * y + (q * r - pd) * z,
                f[2] + (p * r - qd) * x + (q * r + pd) * y - (p * p + q * q) * z,
            ];
            let mut accel = [
                clean[0] - pitch_tilt * clean[2] + size(Kind::AccelerometerBiasX),
                clean[1] * (1.0 + size(Kind::AccelerometerScaleY))
                    + roll_tilt * clean[2]
                    + size(Kind::AccelerometerBiasY),
                clean[2] + pitch_tilt * clean[0] - roll_tilt * clean[1],
            ];
            for (a, shake) in accel.iter_mut().zip(&mut vibration) {
                *a += shake.next(source);
            }
            let mut white = |sd: f64| sd * source.normal();
            Sample {
                t_s: truth.motion.t_s,
                accel_mps2: accel,
                rates_radps: [
                    off(rates[0][i], Kind::RollRateScale, Kind::RollRateBias)
                        + white(noise.rate_radps),
                    off(rates[1][i], Kind::PitchRateScale, Kind::PitchRateBias)
                        + white(noise.rate_radps),
                    off(rates[2][i], Kind::YawRateScale, Kind::YawRateBias)
                        + white(noise.rate_radps),
                ],
                v_mps: off(speed[i], Kind::SpeedScale, Kind::SpeedBias) + white(noise.speed_mps),
                alpha_rad: off(shown[i], Kind::SlipScale, Kind::SlipOffset) + white(noise.slip_rad),
                delta_rad: off(steered[i], Kind::SteerScale, Kind::SteerOffset)
                    + white(noise.steer_rad),
                gamma_rad: off(split[i], Kind::RollSplitScale, Kind::RollSplitBias)
                    + white(noise.roll_split_rad),
                extra: truth.motion.extra,
            }
        })
        .collect()
}

/// A series so many samples later, by the cubic of Catmull and Rom; its first value before the
/// start.
fn delayed(values: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 {
        return values.to_vec();
    }
    let last = values.len() as isize - 1;
    let at = |k: isize| values[k.clamp(0, last) as usize];
    (0..=last)
        .map(|k| {
            let x = k as f64 - by;
            let i = x.floor();
            let (f, i) = (x - i, i as isize);
            let [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
            let (slope, end) = (0.5 * (c - a), 0.5 * (d - b));
            let (bend, turn) = (
                3.0 * (c - b) - 2.0 * slope - end,
                2.0 * (b - c) + slope + end,
            );
            b + f * (slope + f * (bend + f * turn))
        })
        .collect()
}

/// A first-order lag `tau y' + y = u`, exact for an input that is linear between samples.
#[derive(Debug, Clone, Copy)]
pub struct Lag {
    tau: f64,
    last: Option<(f64, f64)>,
}

impl Lag {
    /// A lag with time constant `tau`; 0 passes the input through.
    pub fn new(tau: f64) -> Self {
        Self { tau, last: None }
    }

    /// The output at the next sample, `step` later, in the same unit as `tau`.
    pub fn next(&mut self, input: f64, step: f64) -> f64 {
        let Some((u, y)) = self.last else {
            self.last = Some((input, input));
            return input;
        };
        let output = if self.tau > 0.0 {
            let keep = (-step / self.tau).exp();
            let ramp = (input - u) / step;
            // y_p(t) = u + ramp (t - tau) solves the ramp; the rest decays
            let behind = u - ramp * self.tau;
            input - ramp * self.tau + (y - behind) * keep
        } else {
            input
        };
        self.last = Some((input, output));
        output
    }
}
