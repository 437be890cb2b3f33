//! Noise of each sensor: as stated, or as estimated from the recordings.

use std::ops::Range;

use kufe_sled::Noise;
use kufe_sled::effects::{SENSORS, Sensor};
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

/// The sensors' noise.
#[derive(Clone, Copy, Debug)]
pub struct SensorNoise {
    columns: [ColumnNoise; SENSORS],
}

const INSTRUMENTS: usize = 6;
/// The sensors of each instrument.
const AXES: [Range<usize>; INSTRUMENTS] = [0..3, 3..6, 6..7, 7..8, 8..9, 9..10];
/// The axis from which an instrument's noise is estimated by differences.
const REFERENCE_AXES: [Sensor; INSTRUMENTS] = [
    Sensor::Ay,
    Sensor::YawRate,
    Sensor::Speed,
    Sensor::Slip,
    Sensor::Steering,
    Sensor::RollSplit,
];
/// Names of the instruments, with the unit of their noise.
const NAMES: [&str; INSTRUMENTS] = [
    "accelerometer [m/s2]",
    "rates [rad/s]",
    "speed [m/s]",
    "slip [rad]",
    "steering [rad]",
    "roll split [rad]",
];
/// Names of the axes.
const AXIS_NAMES: [&str; SENSORS] = ["x", "y", "z", "roll", "pitch", "yaw", "", "", "", ""];

/// Standard deviations by instrument.
fn each(noise: &Noise) -> [f64; INSTRUMENTS] {
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
fn of_each(sd: [f64; INSTRUMENTS]) -> Noise {
    Noise {
        accel_mps2: sd[0],
        rate_radps: sd[1],
        speed_mps: sd[2],
        slip_rad: sd[3],
        steer_rad: sd[4],
        roll_split_rad: sd[5],
    }
}

impl SensorNoise {
    /// White noise of these standard deviations.
    pub fn white(sd: Noise) -> Self {
        let silent = ColumnNoise {
            sd: 0.0,
            colour: Colour::WHITE,
        };
        Self {
            columns: [silent; SENSORS],
        }
        .at_least(&sd)
    }

    /// The noise of a sensor at the recorded rate.
    pub fn of(&self, sensor: Sensor) -> ColumnNoise {
        self.columns[sensor as usize]
    }

    /// Noise from the recordings' spectra above this frequency; `None` if they are insufficient. An
    /// axis with more than `max_ratio` times the power of its instrument's quietest axis is
    /// dominated by motion and gets the noise of the quietest axis.
    pub fn of_spectra(training: &[TrainingSamples], from_hz: f64, max_ratio: f64) -> Option<Self> {
        let of_axes = |axes: &Range<usize>| {
            of_instrument(training, &Sensor::ALL[axes.clone()], from_hz, max_ratio)
        };
        let each: Vec<Option<Vec<ColumnNoise>>> = AXES.par_iter().map(of_axes).collect();
        let columns = each.into_iter().collect::<Option<Vec<_>>>()?.concat();
        let columns = columns.try_into().ok()?;
        Some(Self { columns })
    }

    /// This noise with a lower bound of each standard deviation.
    pub fn at_least(mut self, least: &Noise) -> Self {
        for (axes, least) in AXES.into_iter().zip(each(least)) {
            for axis in &mut self.columns[axes] {
                axis.sd = axis.sd.max(least);
            }
        }
        self
    }

    /// Standard deviation of each instrument's noisiest axis, as white noise.
    pub fn sd(&self) -> Noise {
        of_each(self.instruments().map(|axes| noisiest_axis(axes).sd))
    }

    fn instruments(&self) -> [&[ColumnNoise]; INSTRUMENTS] {
        AXES.map(|axes| &self.columns[axes])
    }

    /// A remark on noise from spectra, if the model states other or none.
    pub fn remark(&self, stated: bool) -> String {
        let why = if stated {
            "the sensors' noise is not the white noise that [noise] states"
        } else {
            "no [noise] in the model"
        };
        let text = |noise: &ColumnNoise| {
            let Colour { knee_hz, corner_hz } = noise.colour;
            let corner = knee_hz.min(corner_hz);
            if corner.is_finite() {
                format!("{:.2e}, less above {corner:.0} Hz", noise.sd)
            } else {
                format!("{:.2e}", noise.sd)
            }
        };
        let labels = AXES.map(|axes| &AXIS_NAMES[axes]);
        let sensors = NAMES.into_iter().zip(labels).zip(self.instruments());
        let each: Vec<String> = sensors
            .filter(|(_, axes)| noisiest_axis(axes).sd > 0.0)
            .map(|((name, labels), axes)| {
                let texts: Vec<String> = axes.iter().map(text).collect();
                if texts.iter().all(|axis| *axis == texts[0]) {
                    return format!("{name} {}", texts[0]);
                }
                let axes = labels.iter().zip(&texts);
                let axes: Vec<String> = axes
                    .map(|(label, text)| format!("{label} {text}"))
                    .collect();
                format!("{name} {}", axes.join(", "))
            })
            .collect();
        format!(
            "{why}: it is taken from the recordings' spectra above the motion: {}",
            each.join("; ")
        )
    }
}

/// The axis of the largest standard deviation.
fn noisiest_axis(axes: &[ColumnNoise]) -> ColumnNoise {
    let more = |a: ColumnNoise, b: &ColumnNoise| if b.sd > a.sd { *b } else { a };
    axes.iter().fold(axes[0], more)
}

/// The stated noise, or the noise of the recordings if it is smaller.
pub fn smaller_noise(stated: &Noise, seen: &Noise, remarks: &mut Vec<String>) -> Noise {
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
    by_instrument(stated, seen, f64::min)
}

/// One of two noises, by instrument.
fn by_instrument(a: &Noise, b: &Noise, pick: fn(f64, f64) -> f64) -> Noise {
    let (a, b) = (each(a), each(b));
    of_each(std::array::from_fn(|k| pick(a[k], b[k])))
}

/// The larger of two noises, by sensor: noise with small differences may be filtered, and noise
/// with little power below a corner may be white.
pub fn larger_noise(a: &Noise, b: &Noise) -> Noise {
    by_instrument(a, b, f64::max)
}

/// Whether the stated noise disagrees with the differences of the recordings, for a sensor from
/// which forces are computed: any but the accelerometer, the first instrument. The noise is then
/// coloured, filtered or misstated, and uncertain at the frequencies of the motion.
pub fn is_contradicted(stated: &Noise, seen: &Noise, [low, high]: [f64; 2]) -> bool {
    let mut others = each(stated).into_iter().zip(each(seen)).skip(1);
    others.any(|(stated, seen)| seen > 0.0 && !(low..=high).contains(&(seen / stated.max(1e-300))))
}

/// White noise from third differences d3, the median over runs: `var = mean(d3^2) / 20`.
pub fn estimate(training: &[TrainingSamples]) -> Noise {
    by_third_differences(training, |_| 1)
}

/// White noise with the power of the recordings between the motion and this corner \[Hz\], the
/// median over runs: third differences of means over half the corner's period, `var = m
/// mean(d3^2)/20` for means over m samples.
pub fn estimate_below(training: &[TrainingSamples], corner_hz: f64) -> Noise {
    by_third_differences(training, |dt| {
        (0.5 / (corner_hz * dt)).round().max(1.0) as usize
    })
}

/// `samples` is the number m of samples of a mean for a time between samples [s].
fn by_third_differences(training: &[TrainingSamples], samples: impl Fn(f64) -> usize) -> Noise {
    let sd = |name: &str| -> f64 {
        let mut each: Vec<f64> = training
            .iter()
            .filter_map(|piece| Some((piece.column(name)?, samples(piece.run.dt_s))))
            .map(|(x, m)| {
                let mean = |part: &[f64]| part.iter().sum::<f64>() / m as f64;
                let means: Vec<f64> = x.chunks_exact(m).map(mean).collect();
                let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).powi(2);
                // Differences across a gap are omitted.
                let squares = means.windows(4).map(third).filter(|x| x.is_finite());
                let (sum, count) = squares.fold((0.0, 0_usize), |(s, n), x| (s + x, n + 1));
                (m as f64 * sum / (20.0 * count.max(1) as f64)).sqrt()
            })
            .collect();
        each.sort_by(f64::total_cmp);
        each.get(each.len() / 2).copied().unwrap_or(0.0)
    };
    of_each(REFERENCE_AXES.map(|axis| sd(axis.name())))
}
