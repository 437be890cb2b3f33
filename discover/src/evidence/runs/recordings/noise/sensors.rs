//! Noise of each sensor: as stated, or as estimated from the recordings.

use kufe_sled::Noise;
use rayon::prelude::*;

use crate::evidence::runs::recordings::noise::axes::{ColumnNoise, of_instrument};
use crate::evidence::runs::recordings::noise::colour::Colour;
use crate::evidence::runs::recordings::training_samples::TrainingSamples;

/// Source of the sensors' noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseFrom {
    /// Stated in the model, in agreement with the recordings.
    Model,
    /// From the recordings' spectra: not stated, or contradicted by the recordings.
    Spectra,
    /// White noise from differences, without a spectrum: not stated, and recordings are too short.
    Differences,
    /// Stated, but contradicted by recordings that are too short or too slow for a spectrum.
    Doubted,
}

/// The sensors' noise, by column.
#[derive(Clone, Copy, Debug)]
pub struct SensorNoise {
    pub accel_mps2: [ColumnNoise; 3],
    pub rate_radps: [ColumnNoise; 3],
    pub speed_mps: ColumnNoise,
    pub slip_rad: ColumnNoise,
    pub steer_rad: ColumnNoise,
    pub roll_split_rad: ColumnNoise,
}

const SENSORS: usize = 6;
/// Names of the sensors, with the unit of their noise.
const NAMES: [&str; SENSORS] = [
    "accelerometer [m/s2]",
    "rates [rad/s]",
    "speed [m/s]",
    "slip [rad]",
    "steering [rad]",
    "roll split [rad]",
];
/// Names of their axes.
const AXES: [&[&str]; SENSORS] = [
    &["x", "y", "z"],
    &["roll", "pitch", "yaw"],
    &[""],
    &[""],
    &[""],
    &[""],
];

/// Standard deviations by sensor.
fn each(noise: &Noise) -> [f64; SENSORS] {
    [
        noise.accel_mps2,
        noise.rate_radps,
        noise.speed_mps,
        noise.slip_rad,
        noise.steer_rad,
        noise.roll_split_rad,
    ]
}

/// Noise of these standard deviations.
fn of_each(sd: [f64; SENSORS]) -> Noise {
    let [
        accel_mps2,
        rate_radps,
        speed_mps,
        slip_rad,
        steer_rad,
        roll_split_rad,
    ] = sd;
    Noise {
        accel_mps2,
        rate_radps,
        speed_mps,
        slip_rad,
        steer_rad,
        roll_split_rad,
    }
}

impl SensorNoise {
    /// White noise of these standard deviations.
    pub fn white(sd: Noise) -> Self {
        let of = |sd| ColumnNoise {
            sd,
            colour: Colour::WHITE,
        };
        Self {
            accel_mps2: [of(sd.accel_mps2); 3],
            rate_radps: [of(sd.rate_radps); 3],
            speed_mps: of(sd.speed_mps),
            slip_rad: of(sd.slip_rad),
            steer_rad: of(sd.steer_rad),
            roll_split_rad: of(sd.roll_split_rad),
        }
    }

    /// Noise from the recordings' spectra above this frequency; `None` if they are insufficient. An
    /// axis with more than `quietest` times the power of its instrument's quietest axis is
    /// dominated by motion and gets the noise of the quietest axis.
    pub fn of_spectra(learned: &[TrainingSamples], from_hz: f64, quietest: f64) -> Option<Self> {
        let each: Vec<Option<Vec<ColumnNoise>>> = INSTRUMENTS
            .par_iter()
            .map(|axes| of_instrument(learned, axes, from_hz, quietest))
            .collect();
        let each: Vec<Vec<ColumnNoise>> = each.into_iter().collect::<Option<_>>()?;
        let axes = |k: usize| <[ColumnNoise; 3]>::try_from(each[k].as_slice()).ok();
        Some(Self {
            accel_mps2: axes(0)?,
            rate_radps: axes(1)?,
            speed_mps: each[2][0],
            slip_rad: each[3][0],
            steer_rad: each[4][0],
            roll_split_rad: each[5][0],
        })
    }

    /// This noise with a lower bound of each standard deviation.
    pub fn at_least(self, least: &Noise) -> Self {
        let of = |noise: ColumnNoise, least: f64| ColumnNoise {
            sd: noise.sd.max(least),
            ..noise
        };
        Self {
            accel_mps2: self.accel_mps2.map(|axis| of(axis, least.accel_mps2)),
            rate_radps: self.rate_radps.map(|axis| of(axis, least.rate_radps)),
            speed_mps: of(self.speed_mps, least.speed_mps),
            slip_rad: of(self.slip_rad, least.slip_rad),
            steer_rad: of(self.steer_rad, least.steer_rad),
            roll_split_rad: of(self.roll_split_rad, least.roll_split_rad),
        }
    }

    /// Standard deviation of each instrument's noisiest axis, as white noise.
    pub fn sd(&self) -> Noise {
        of_each(self.instruments().map(|axes| loudest(axes).sd))
    }

    fn instruments(&self) -> [&[ColumnNoise]; INSTRUMENTS.len()] {
        use std::slice::from_ref;
        [
            &self.accel_mps2,
            &self.rate_radps,
            from_ref(&self.speed_mps),
            from_ref(&self.slip_rad),
            from_ref(&self.steer_rad),
            from_ref(&self.roll_split_rad),
        ]
    }

    /// A remark on noise from spectra, if the model states other or none.
    pub fn remark(&self, stated: bool) -> String {
        let why = match stated {
            true => "the sensors' noise is not the white noise that [noise] states",
            false => "no [noise] in the model",
        };
        let of = |noise: &ColumnNoise| {
            let Colour { knee_hz, corner_hz } = noise.colour;
            match knee_hz.min(corner_hz) {
                corner if corner.is_finite() => {
                    format!("{:.2e}, less above {corner:.0} Hz", noise.sd)
                }
                _ => format!("{:.2e}", noise.sd),
            }
        };
        let sensors = NAMES.into_iter().zip(AXES).zip(self.instruments());
        let each: Vec<String> = sensors
            .filter(|(_, axes)| loudest(axes).sd > 0.0)
            .map(|((name, labels), axes)| {
                let texts: Vec<String> = axes.iter().map(of).collect();
                match texts.iter().all(|axis| *axis == texts[0]) {
                    true => format!("{name} {}", texts[0]),
                    false => {
                        let axes = labels.iter().zip(&texts);
                        let axes: Vec<String> =
                            axes.map(|(l, texts)| format!("{l} {texts}")).collect();
                        format!("{name} {}", axes.join(", "))
                    }
                }
            })
            .collect();
        format!(
            "{why}: it is taken from the recordings' spectra above the motion: {}",
            each.join("; ")
        )
    }
}

/// The axis of the largest standard deviation.
fn loudest(axes: &[ColumnNoise]) -> ColumnNoise {
    let more = |a: ColumnNoise, b: &ColumnNoise| if b.sd > a.sd { *b } else { a };
    axes.iter().fold(axes[0], more)
}

/// Columns of each instrument.
const INSTRUMENTS: [&[&str]; SENSORS] = [
    &["ax_mps2", "ay_mps2", "az_mps2"],
    &["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"],
    &["v_mps"],
    &["alpha_rad"],
    &["delta_rad"],
    &["gamma_rad"],
];

/// The column from which each sensor's noise is estimated by differences.
const COLUMNS: [&str; SENSORS] = [
    "ay_mps2",
    "yaw_rate_radps",
    "v_mps",
    "alpha_rad",
    "delta_rad",
    "gamma_rad",
];

/// The stated noise, or the noise of the recordings if it is smaller.
pub fn quieter(stated: &Noise, seen: &Noise, remarks: &mut Vec<String>) -> Noise {
    let both = each(stated).into_iter().zip(each(seen));
    let smaller: Vec<String> = NAMES
        .iter()
        .zip(both)
        .filter(|(_, (stated, seen))| *seen < 0.9 * stated)
        .map(|(name, (stated, seen))| format!("{name} {stated:.2e} stated, {seen:.2e} observed"))
        .collect();
    if !smaller.is_empty() {
        remarks.push(format!(
            "sensors with less noise than [noise] states; the smaller value is used: {}",
            smaller.join("; ")
        ));
    }
    by_sensor(stated, seen, f64::min)
}

/// One of two noises, by sensor.
fn by_sensor(a: &Noise, b: &Noise, pick: fn(f64, f64) -> f64) -> Noise {
    let (a, b) = (each(a), each(b));
    of_each(std::array::from_fn(|k| pick(a[k], b[k])))
}

/// The larger of two noises, by sensor: noise with small differences may be filtered, and noise
/// with little power below a corner may be white.
pub fn louder(a: &Noise, b: &Noise) -> Noise {
    by_sensor(a, b, f64::max)
}

/// Whether the stated noise disagrees with the differences of the recordings, for a sensor from
/// which forces are computed. The noise is then coloured, filtered or misstated, and uncertain at
/// the frequencies of the motion.
pub fn doubted(stated: &Noise, seen: &Noise, [low, high]: [f64; 2]) -> bool {
    [
        (stated.rate_radps, seen.rate_radps),
        (stated.speed_mps, seen.speed_mps),
        (stated.slip_rad, seen.slip_rad),
        (stated.steer_rad, seen.steer_rad),
        (stated.roll_split_rad, seen.roll_split_rad),
    ]
    .iter()
    .any(|(stated, seen)| *seen > 0.0 && !(low..=high).contains(&(seen / stated.max(1e-300))))
}

/// White noise from third differences d3, the median over runs: `var = mean(d3^2) / 20`.
pub fn estimate(learned: &[TrainingSamples]) -> Noise {
    by_third_differences(learned, &|_| 1)
}

/// White noise with the power of the recordings between the motion and this corner \[Hz\], the
/// median over runs: third differences of means over half the corner's period, `var = m
/// mean(d3^2)/20` for means over m samples.
pub fn estimate_below(learned: &[TrainingSamples], corner_hz: f64) -> Noise {
    let samples =
        |piece: &TrainingSamples| (0.5 / (corner_hz * piece.run.dt_s)).round().max(1.0) as usize;
    by_third_differences(learned, &samples)
}

fn by_third_differences(
    learned: &[TrainingSamples],
    samples: &dyn Fn(&TrainingSamples) -> usize,
) -> Noise {
    let sd = |name: &str| -> f64 {
        let mut each: Vec<f64> = learned
            .iter()
            .filter_map(|piece| Some((piece.column(name)?, samples(piece))))
            .map(|(x, m)| {
                let mean = |part: &[f64]| part.iter().sum::<f64>() / m as f64;
                let means: Vec<f64> = x.chunks_exact(m).map(mean).collect();
                let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).powi(2);
                // Differences across a gap are omitted.
                let squares = means
                    .windows(4)
                    .map(third)
                    .filter(|square| square.is_finite());
                let (sum, count) = squares.fold((0.0, 0_usize), |(s, n), x| (s + x, n + 1));
                (m as f64 * sum / (20.0 * count.max(1) as f64)).sqrt()
            })
            .collect();
        each.sort_by(f64::total_cmp);
        each.get(each.len() / 2).copied().unwrap_or(0.0)
    };
    of_each(COLUMNS.map(sd))
}
