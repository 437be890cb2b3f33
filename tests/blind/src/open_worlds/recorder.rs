//! The recorder: sensors at their places, rotated, late, filtered, off, noisy and quantised.

use std::f64::consts::{PI, SQRT_2};

use super::faults::{Faults, Session};
use super::hidden::{Acts, Secret};
use super::ride::Truth;
use super::sled::Sled;
use crate::world::noise::Source;

/// Recorded channels: accelerations, rates, speed, slip, steering, roll split.
pub const CHANNELS: usize = 10;
/// Rows a second.
pub const ROWS_HZ: f64 = 100.0;
/// Standard deviations of the noise of the rows.
pub const NOISE: [f64; CHANNELS] = [
    0.08, 0.08, 0.08, 0.0012, 0.0012, 0.0012, 0.025, 0.0005, 0.0003, 0.0003,
];
/// Steps in which the channels are recorded, times the scale.
const STEPS: [f64; CHANNELS] = [0.02, 0.02, 0.02, 5e-4, 5e-4, 5e-4, 0.02, 2e-4, 1e-4, 2e-4];
/// Corners of the channels' filters of scale 1 [Hz].
const CORNERS_HZ: [f64; CHANNELS] = [45.0, 45.0, 45.0, 45.0, 45.0, 45.0, 15.0, 25.0, 25.0, 25.0];
/// Readings of the speed a second at scale 1; the rows between are interpolated.
const SPEEDS_HZ: f64 = 25.0;

/// A row: the channels, and the runner's temperature.
pub type Row = [f64; CHANNELS + 1];

/// A recorder on a sled.
#[derive(Debug, Clone, Copy)]
pub struct Recorder<'a> {
    /// The true sled.
    pub sled: &'a Sled,
    /// What is wrong.
    pub faults: &'a Faults,
    /// What is hidden.
    pub secret: &'a Secret,
    /// Steps a second of what is recorded.
    pub rate_hz: f64,
}

/// Delay of every channel at low frequencies [s]: its own, and `sqrt(2)/(2 pi f)` of a Butterworth
/// filter of second order with the corner f.
pub fn delays(faults: &Faults) -> [f64; CHANNELS] {
    std::array::from_fn(|c| faults.delay_s[c] + faults.scale * SQRT_2 / (2.0 * PI * CORNERS_HZ[c]))
}

impl Recorder<'_> {
    /// Records a ride, with noise where there is a source for it.
    pub fn record(
        &self,
        truths: &[Truth],
        session: &Session,
        mut noise: Option<&mut Source>,
    ) -> Vec<Row> {
        let readings: Vec<[f64; CHANNELS]> = truths.iter().map(|t| self.reading(t)).collect();
        let rows = (truths.len() as f64 / self.rate_hz * ROWS_HZ) as usize;
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for c in 0..CHANNELS {
            let raw: Vec<f64> = readings.iter().map(|row| row[c]).collect();
            let corner = (CORNERS_HZ[c] / self.faults.scale).min(0.4 * self.rate_hz);
            let smooth = filtered(&raw, corner, self.rate_hz);
            let delay = self.faults.delay_s[c] + self.secret.of(Acts::Delay(c));
            let clock = if c >= 7 { self.faults.clock } else { 0.0 };
            let factor =
                (1.0 + self.faults.channel_scale[c]) * (1.0 + self.secret.of(Acts::Scale(c)));
            let offset = match c {
                3..=5 => session.gyro_bias_radps[c - 3],
                7 | 8 => session.offset_rad[c - 7],
                _ => 0.0,
            };
            let mut at = |t: f64| {
                // Truths are at the middle of steps.
                let x = (t * (1.0 + clock) - delay) * self.rate_hz - 0.5;
                let noise = noise
                    .as_mut()
                    .map_or(0.0, |source| NOISE[c] * source.normal());
                factor * interpolated(&smooth, x) + offset + noise
            };
            let speeds_hz = SPEEDS_HZ / self.faults.scale;
            let column = match c == 6 && speeds_hz < ROWS_HZ {
                false => (0..rows).map(|k| at(k as f64 / ROWS_HZ)).collect(),
                true => {
                    let count = (rows as f64 * speeds_hz / ROWS_HZ) as usize + 2;
                    let few: Vec<f64> = (0..count).map(|k| at(k as f64 / speeds_hz)).collect();
                    let row = |k| interpolated(&few, k as f64 * speeds_hz / ROWS_HZ);
                    (0..rows).map(row).collect::<Vec<f64>>()
                }
            };
            columns.push(column);
        }
        let step = STEPS.map(|step| step * self.faults.scale);
        let stride = self.rate_hz / ROWS_HZ;
        (0..rows)
            .map(|k| {
                let runner_c = truths[(k as f64 * stride) as usize].runner_c;
                std::array::from_fn(|c| match c < CHANNELS {
                    true => (columns[c][k] / step[c]).round() * step[c],
                    false => runner_c,
                })
            })
            .collect()
    }

    /// What sensors without delay, bias and noise read at their places.
    ///
    /// `f = f_c + w' x l + w x (w x l)`, then in the axes of a box that is rotated by small angles:
    /// `f - theta x f`, and gyros that feel the specific force.
    fn reading(&self, truth: &Truth) -> [f64; CHANNELS] {
        let (w, l) = (truth.rates_radps, self.sled.accel_m);
        let (swing, spin) = (cross(truth.rates_slope, l), cross(w, cross(w, l)));
        let at_box: [f64; 3] = std::array::from_fn(|k| truth.felt_mps2[k] + swing[k] + spin[k]);
        let angles = self.faults.misaligned_rad;
        let boxed = |v: [f64; 3]| {
            // Second order: the rotation's matrix is I - [theta] + [theta]^2/2.
            let once = cross(angles, v);
            let twice = cross(angles, once);
            std::array::from_fn::<f64, 3, _>(|k| v[k] - once[k] + 0.5 * twice[k])
        };
        let (f, mut rates) = (boxed(at_box), boxed(w));
        for (rate, by) in rates.iter_mut().zip(&self.faults.g_sensitivity) {
            *rate += by[0] * f[0] + by[1] * f[1] + by[2] * f[2];
        }
        let [vx, vy] = truth.velocity_mps;
        let across = vy + truth.rates_radps[2] * self.sled.slip_m;
        [
            f[0],
            f[1],
            f[2],
            rates[0],
            rates[1],
            rates[2],
            vx.hypot(across),
            -across.atan2(vx),
            truth.steer_rad,
            truth.split_rad,
        ]
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The value at a fractional place, linear, and that of the nearest end beyond the ends.
fn interpolated(values: &[f64], x: f64) -> f64 {
    let x = x.clamp(0.0, (values.len() - 1) as f64);
    let low = (x as usize).min(values.len().saturating_sub(2));
    let part = x - low as f64;
    let high = (low + 1).min(values.len() - 1);
    values[low] + part * (values[high] - values[low])
}

/// Butterworth low-pass of second order, by the bilinear transform; starts at rest.
fn filtered(values: &[f64], corner_hz: f64, rate_hz: f64) -> Vec<f64> {
    let k = (PI * corner_hz / rate_hz).tan();
    let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let gain = k * k * norm;
    let (a1, a2) = (
        2.0 * (k * k - 1.0) * norm,
        (1.0 - SQRT_2 * k + k * k) * norm,
    );
    let first = values.first().copied().unwrap_or(0.0);
    let (mut x, mut y) = ([first; 2], [first; 2]);
    let mut next = |value: f64| {
        let out = gain * (value + 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
        (x, y) = ([value, x[0]], [out, y[0]]);
        out
    };
    values.iter().map(|value| next(*value)).collect()
}
