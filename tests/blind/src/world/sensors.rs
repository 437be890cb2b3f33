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
    let lag = size(Kind::SlipLag);
    let mut vibration: Vec<Ar1> = (0..3)
        .map(|_| Ar1::new(noise.colour, noise.accel_mps2, source))
        .collect();
    let mut slip_filter = Lag::new(lag);
    let mut steering_filter = Lag::new(size(Kind::SteerLag));
    truths
        .iter()
        .map(|truth| {
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
                clean[1] + roll_tilt * clean[2] + size(Kind::AccelerometerBiasY),
                clean[2] + pitch_tilt * clean[0] - roll_tilt * clean[1],
            ];
            for (a, shake) in accel.iter_mut().zip(&mut vibration) {
                *a += shake.next(source);
            }
            let [vx, vy] = truth.velocity_mps;
            let alpha = -(vy + r * sled.slip_x_m).atan2(vx);
            let shown = slip_filter.next(alpha, SAMPLE_S);
            let steered = steering_filter.next(truth.motion.delta_rad, SAMPLE_S);
            let mut white = |sd: f64| sd * source.normal();
            Sample {
                t_s: truth.motion.t_s,
                accel_mps2: accel,
                rates_radps: [
                    p + white(noise.rate_radps),
                    q + white(noise.rate_radps),
                    r * (1.0 + size(Kind::YawRateScale))
                        + size(Kind::YawRateBias)
                        + white(noise.rate_radps),
                ],
                v_mps: truth.motion.v_mps * (1.0 + size(Kind::SpeedScale)) + white(noise.speed_mps),
                alpha_rad: shown * (1.0 + size(Kind::SlipScale))
                    + size(Kind::SlipOffset)
                    + white(noise.slip_rad),
                delta_rad: steered + size(Kind::SteerOffset) + white(noise.steer_rad),
                gamma_rad: truth.motion.gamma_rad + white(noise.roll_split_rad),
                extra: truth.motion.extra,
            }
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
