//! The recorder: sensors at their places, late, filtered, off by scale and bias, and noisy.

use std::f64::consts::{PI, SQRT_2};

use super::ride::{RATE_HZ, Truth};
use super::runners::Sled;
use super::wrong::{CHANNELS, Fault, Wrong};
use crate::world::noise::Source;

/// Rows a second in the files.
pub const ROWS_HZ: f64 = 100.0;

/// True standard deviations of the channels' noise.
pub const NOISE: [f64; CHANNELS] = [
    0.06, 0.06, 0.06, 0.0012, 0.0012, 0.0012, 0.025, 0.0006, 0.0003, 0.0003,
];

/// A row of all channels.
pub type Row = [f64; CHANNELS];

/// A recorder on a sled of a world, with a fault or none.
#[derive(Debug, Clone, Copy)]
pub struct Recorder<'a> {
    /// The true sled.
    pub sled: &'a Sled,
    /// What is wrong with it in this world.
    pub wrong: &'a Wrong,
    /// What is hidden in it.
    pub fault: Option<(Fault, f64)>,
}

impl Recorder<'_> {
    /// Records a ride: one row of all channels every hundredth of a second.
    pub fn record(&self, truths: &[Truth], source: &mut Source) -> Vec<Row> {
        let late = self.late(truths, RATE_HZ);
        let mut rows = self.rows(&late, RATE_HZ);
        let hiss = self.hiss(&late, RATE_HZ, source);
        for (row, hiss) in rows.iter_mut().zip(&hiss) {
            *row = std::array::from_fn(|c| row[c] + hiss[c]);
        }
        rows
    }

    /// What sensors hand to the recorder: late, and through the filters.
    pub fn late(&self, truths: &[Truth], rate_hz: f64) -> [Vec<f64>; CHANNELS] {
        let clean: Vec<Row> = truths.iter().map(|t| readings(self.sled, t)).collect();
        std::array::from_fn(|c| {
            let mut delay = self.wrong.delay_s[c];
            match self.fault {
                Some((Fault::Delay(at), size)) if at == c => delay += size,
                _ => {}
            }
            let values: Vec<f64> = clean.iter().map(|row| row[c]).collect();
            let late = later(&values, delay * rate_hz);
            filtered(&late, self.wrong.filter_hz, rate_hz)
        })
    }

    /// The rows that a recorder without noise would write.
    pub fn rows(&self, late: &[Vec<f64>; CHANNELS], rate_hz: f64) -> Vec<Row> {
        let stride = (rate_hz / ROWS_HZ) as usize;
        let read = |c: usize, k: usize| {
            let (mut scale, mut bias) = (1.0, 0.0);
            if (3..6).contains(&c) {
                scale += self.wrong.gyro_scale[c - 3];
                bias += self.wrong.gyro_bias_radps[c - 3];
            }
            let (x, t) = (scale * late[c][k] + bias, k as f64 / rate_hz);
            let fault = self.fault;
            fault.map_or(x, |(fault, size)| fault.read(c, size, x, t))
        };
        (0..late[0].len())
            .step_by(stride)
            .map(|k| std::array::from_fn(|c| read(c, k)))
            .collect()
    }

    /// The noise of as many rows.
    pub fn hiss(&self, late: &[Vec<f64>; CHANNELS], rate_hz: f64, source: &mut Source) -> Vec<Row> {
        let stride = (RATE_HZ / ROWS_HZ) as usize;
        let columns: [Vec<f64>; CHANNELS] = std::array::from_fn(|c| {
            let sd = self
                .wrong
                .noise
                .map_or(NOISE[c], |share| share * spread(&late[c]));
            let count = (late[c].len() as f64 * RATE_HZ / rate_hz) as usize;
            noise(
                count,
                sd,
                [self.wrong.colour[c], self.wrong.filter_hz],
                source,
            )
        });
        (0..columns[0].len())
            .step_by(stride)
            .map(|k| std::array::from_fn(|c| columns[c][k]))
            .collect()
    }
}

/// Standard deviation of a series.
fn spread(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// What perfect sensors read at their places: `f = f_c + dw/dt x l + w x (w x l)`.
fn readings(sled: &Sled, truth: &Truth) -> [f64; CHANNELS] {
    let (w, l) = (truth.rate, sled.accel_m);
    let swing = cross(truth.rate_slope, l);
    let spin = cross(w, cross(w, l));
    let f = truth.felt;
    let (vx, vy) = (truth.v * truth.beta.cos(), truth.v * truth.beta.sin());
    [
        f[0] + swing[0] + spin[0],
        f[1] + swing[1] + spin[1],
        f[2] + swing[2] + spin[2],
        w[0],
        w[1],
        w[2],
        truth.v,
        -(vy + w[2] * sled.slip_m).atan2(vx),
        truth.steer,
        truth.split,
    ]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The series `by` samples later, linear in between.
fn later(values: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 {
        return values.to_vec();
    }
    (0..values.len())
        .map(|k| {
            let x = (k as f64 - by).max(0.0);
            let i = (x as usize).min(values.len().saturating_sub(2));
            let f = x - i as f64;
            values[i] * (1.0 - f) + values[(i + 1).min(values.len() - 1)] * f
        })
        .collect()
}

/// A Butterworth low-pass of second order by the bilinear transform, started at rest on the first
/// value.
fn filtered(values: &[f64], corner_hz: f64, rate_hz: f64) -> Vec<f64> {
    if corner_hz.is_infinite() {
        return values.to_vec();
    }
    let k = (PI * corner_hz / rate_hz).tan();
    let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let gain = k * k * norm;
    let (a1, a2) = (
        2.0 * (k * k - 1.0) * norm,
        (1.0 - SQRT_2 * k + k * k) * norm,
    );
    let first = values.first().copied().unwrap_or(0.0);
    let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
    values
        .iter()
        .map(|&x| {
            let y = gain * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            y
        })
        .collect()
}

/// Noise with this standard deviation, this correlation from one millisecond to the next, and
/// through a filter of this corner [Hz].
fn noise(count: usize, sd: f64, [keep, corner_hz]: [f64; 2], source: &mut Source) -> Vec<f64> {
    let mut state = source.normal();
    let raw: Vec<f64> = (0..count)
        .map(|_| {
            state = keep * state + (1.0 - keep * keep).sqrt() * source.normal();
            state
        })
        .collect();
    let shaped = filtered(&raw, corner_hz, RATE_HZ);
    let spread = (shaped.iter().map(|x| x * x).sum::<f64>() / count.max(1) as f64).sqrt();
    shaped.iter().map(|x| sd * x / spread.max(1e-300)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::wrong::World;
    use super::*;

    #[test]
    fn faults_of_a_channel_leave_the_others_and_bend_it_as_they_say() {
        let saturating = Fault::Saturating(5);
        assert_eq!(saturating.read(4, 0.7, 0.3, 1.0), 0.3);
        // tanh x = x - x^3 / 3 + ...
        let cubic = 0.1 - 0.1_f64.powi(3) / (3.0 * 0.7 * 0.7);
        assert!((saturating.read(5, 0.7, 0.1, 1.0) - cubic).abs() < 1e-5);
        let warm = Fault::Warming(7).read(7, 0.004, 0.001, 1e3);
        assert!((warm - 0.005).abs() < 1e-12);
        assert_eq!(Fault::Stepping(6).read(6, 0.8, 20.9, 0.0), 20.9);
        assert_eq!(Fault::Stepping(6).read(6, 0.8, 22.0, 0.0), 22.8);
        assert!((Fault::Bowed(8).read(8, 2.0, -0.05, 0.0) + 0.045).abs() < 1e-15);
    }

    #[test]
    fn noise_of_a_share_is_that_share_of_what_a_channel_spreads() {
        let source = &mut Source::new(4, "noise");
        let mut wrong = Wrong::draw(World::Noise(100), source);
        let wave = |k: usize| (2.0 * PI * k as f64 / 500.0).sin();
        let truths: Vec<Truth> = (0..20_000)
            .map(|k| Truth {
                v: 20.0 + 3.0 * wave(k),
                ..Truth::default()
            })
            .collect();
        let sled = &Sled::published();
        let mut rows = |wrong: &Wrong| {
            let recorder = Recorder {
                sled,
                wrong,
                fault: None,
            };
            recorder.record(&truths, source)
        };
        let noisy = rows(&wrong);
        wrong.noise = Some(0.0);
        let still = rows(&wrong);
        let off: Vec<f64> = noisy.iter().zip(&still).map(|(a, b)| a[6] - b[6]).collect();
        assert!((still[30][6] - truths[300].v).abs() < 1e-12);
        // A tenth of 3 / sqrt 2, to what 2000 samples tell of a spread.
        assert!((spread(&off) / (0.3 / SQRT_2) - 1.0).abs() < 0.06);
    }

    #[test]
    fn a_filtered_and_delayed_wave_is_late_and_weaker_as_the_textbook_says() {
        let wave: Vec<f64> = (0..4000)
            .map(|k| (2.0 * PI * 30.0 * k as f64 / RATE_HZ).sin())
            .collect();
        let largest = |values: &[f64]| values[2000..].iter().fold(0.0f64, |m, v| m.max(v.abs()));
        // A Butterworth filter halves the power at its corner.
        assert!((largest(&filtered(&wave, 30.0, RATE_HZ)) - 0.5f64.sqrt()).abs() < 2e-3);
        let shifted = later(&wave, 7.0);
        assert!((shifted[1007] - wave[1000]).abs() < 1e-12);
    }
}
