//! A drive in formulas, whose sensors can be evaluated at any time, and files that loggers might write
//! of it.

use std::f64::consts::TAU;
use std::path::Path;

use kufe_telemetry::{Imported, Importer, plan};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Columns of a run, in the order of [`at`].
pub const COLUMNS: [&str; 10] = [
    "ax_mps2",
    "ay_mps2",
    "az_mps2",
    "roll_rate_radps",
    "pitch_rate_radps",
    "yaw_rate_radps",
    "v_mps",
    "alpha_rad",
    "delta_rad",
    "gamma_rad",
];

/// Speed [m/s] and its derivative.
pub fn speed(t: f64) -> [f64; 2] {
    let parts = [(3.0, 0.11, 0.3), (1.1, 0.37, 1.9), (0.3, 0.83, 4.0)];
    let v = parts
        .iter()
        .map(|(a, f, p)| a * (TAU * f * t + p).sin())
        .sum::<f64>();
    let dv = parts
        .iter()
        .map(|(a, f, p)| a * TAU * f * (TAU * f * t + p).cos())
        .sum::<f64>();
    [25.0 + v, dv]
}

/// What perfect sensors at the centre of gravity of a body on a level plane read: `ax = dv/dt`,
/// `ay = r v`, `az = g - q v`.
pub fn at(t: f64) -> [f64; 10] {
    let wave = |amplitude: f64, f: f64, phase: f64| amplitude * (TAU * f * t + phase).sin();
    let [v, dv] = speed(t);
    let yaw = wave(0.3, 0.23, 0.0) + wave(0.12, 0.61, 1.0) + wave(0.05, 1.3, 2.0);
    let pitch = wave(0.1, 0.31, 0.5) + wave(0.05, 0.9, 1.5);
    let roll = wave(0.2, 0.41, 2.5);
    let ay = yaw * v;
    let az = 9.806_65 - pitch * v;
    let alpha = wave(0.02, 0.29, 0.7);
    let delta = wave(0.05, 0.23, 0.1) + wave(0.01, 1.1, 0.0);
    let gamma = wave(0.01, 0.5, 0.2);
    [dv, ay, az, roll, pitch, yaw, v, alpha, delta, gamma]
}

/// A column of the truth.
pub fn column(name: &str, t: f64) -> f64 {
    let place = COLUMNS.iter().position(|known| *known == name);
    at(t)[place.unwrap_or_else(|| panic!("no column {name}"))]
}

/// Imports every run of a mapping that is written into `folder`.
pub fn import(folder: &Path, mapping: &str) -> Result<Vec<Imported>, String> {
    let importer = Importer::new(mapping, "mapping.toml").map_err(|error| error.to_string())?;
    let plan =
        plan(importer.mapping(), folder, "mapping.toml").map_err(|error| error.to_string())?;
    plan.runs
        .iter()
        .map(|run| importer.run(run).map_err(|error| error.to_string()))
        .collect()
}

/// One logger's way to write a column: the column's value to that of the file.
pub type Writes<'a> = (&'a str, &'a dyn Fn(f64) -> f64, f64);

/// A logger: its clock is `delay_s` ahead of the true time, in its own unit.
pub struct Logger<'a> {
    pub rate_hz: f64,
    pub delay_s: f64,
    /// Seconds to the unit of its time.
    pub time: f64,
    /// Column, value written of it, and standard deviation of its noise in the column's unit.
    pub columns: &'a [Writes<'a>],
}

/// The text that it writes from `from` to `to` of the true time: comma-separated, one line of names
/// as the columns are called.
pub fn recording(logger: &Logger, from: f64, to: f64, seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let names: Vec<&str> = logger.columns.iter().map(|(name, ..)| *name).collect();
    let mut text = format!("time,{}\n", names.join(","));
    let count = ((to - from) * logger.rate_hz) as usize;
    for row in 0..=count {
        let t = from + row as f64 / logger.rate_hz;
        let mut cells = vec![format!("{:.9}", (t + logger.delay_s) * logger.time)];
        for (name, write, noise) in logger.columns {
            let error: f64 = StandardNormal.sample(&mut random);
            cells.push(format!("{:.9}", write(column(name, t) + noise * error)));
        }
        text += &cells.join(",");
        text.push('\n');
    }
    text
}
