//! Simulated runs of the fitted model, with sensor noise through the whole signal processing.
//!
//! The measured motion is taken as the truth, with accelerations changed so that the model's
//! residuals vanish. Noise of each sensor at the recorded rate is added; it is smoothed and
//! differentiated as the data were. The part of the residual that noise does not explain is added
//! as a copy of itself, shifted along the run and with a random sign. Simulated runs come in
//! antithetic pairs (opposite noise), so that odd terms cancel in a pair's mean and the bias of
//! products of noisy signals remains.

use std::sync::Arc;

use kufe_sled::Noise;
use kufe_sled::effects::{SENSORS, Sensor, ahead};
use rand::Rng;
use rayon::prelude::*;

use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::model::residual_model::{CHANNELS, ChannelRows, ResidualModel};
use crate::evidence::runs::model::whiten::scaled;
use crate::evidence::runs::recordings::frame::{Frame, ReadingVariances, RowNoise};
use crate::evidence::runs::recordings::noise::sensors::SensorNoise;
use crate::evidence::runs::recordings::smooth_run::signal_kernel;
use crate::null::random::{below, sign, stream};
use crate::procedure::rules::{RecordingRules, RunRules};

/// Simulator of runs with sensor noise and unexplained residuals.
#[derive(Clone, Debug)]
pub struct RunSimulator {
    noise: SensorNoise,
    /// Share of each channel's residual that sensor noise does not explain, as a standard
    /// deviation.
    pub unexplained: [f64; CHANNELS],
    seed: u64,
    signals: RecordingRules,
    /// Shortest piece of a run to be simulated [s].
    pub piece_s: f64,
}

/// Lower bound of the noise, for noiseless sensors: only ratios between models are compared.
const MIN_NOISE: Noise = Noise {
    accel_mps2: 1e-4,
    rate_radps: 1e-6,
    speed_mps: 1e-4,
    slip_rad: 1e-6,
    steer_rad: 1e-6,
    roll_split_rad: 1e-6,
};

/// The order in which noise is drawn.
const NOISE_ORDER: [Sensor; SENSORS] = [
    Sensor::Ax,
    Sensor::RollRate,
    Sensor::Ay,
    Sensor::PitchRate,
    Sensor::Az,
    Sensor::YawRate,
    Sensor::Speed,
    Sensor::Slip,
    Sensor::Steering,
    Sensor::RollSplit,
];

/// A simulated run without noise and with noise of both signs.
pub struct SimulatedPair {
    pub truth: Frame,
    pub plus: Frame,
    /// With the opposite noise.
    pub minus: Frame,
}

impl RunSimulator {
    /// Determines the share of the residuals that sensor noise explains.
    pub fn new(
        frames: &[Frame],
        residual_model: &ResidualModel,
        noise: SensorNoise,
        used: [bool; CHANNELS],
        (seed, rules): (u64, &RunRules),
    ) -> Self {
        let mut simulator = Self::of_sensors(noise, (seed, rules));
        // Sums of squares of each run and of its simulation.
        let powers = |(i, frame): (usize, &Frame)| -> [[f64; CHANNELS]; 2] {
            let simulated = simulator.pair(frame, residual_model, 1_000_003, i).plus;
            [frame, &simulated].map(|run| {
                let rows = scaled(frame, &residual_model.residuals(run));
                rows.map(|r| r.iter().map(|x| x * x).sum())
            })
        };
        let powers: Vec<_> = frames.par_iter().enumerate().map(powers).collect();
        for (c, used) in used.iter().enumerate() {
            let total: f64 = powers.iter().map(|p| p[0][c]).sum();
            let explained: f64 = powers.iter().map(|p| p[1][c]).sum();
            if *used && total > 0.0 {
                simulator.unexplained[c] = (1.0 - explained / total).max(0.0).sqrt();
            }
        }
        simulator
    }

    /// A simulator of sensor noise alone.
    pub fn of_sensors(noise: SensorNoise, (seed, rules): (u64, &RunRules)) -> Self {
        Self {
            noise,
            unexplained: [0.0; CHANNELS],
            seed,
            signals: rules.recordings,
            piece_s: rules.noise_piece_s,
        }
    }

    /// Runs with the sensor noise of their rows.
    pub fn with_row_noise(&self, frames: &[Frame]) -> Vec<Frame> {
        /// Samples of a run at which its noise is evaluated. Chosen: some hundred in all.
        const SAMPLES: usize = 12;
        let variances = self.row_variances(frames);
        let noisy = |frame: &Frame| {
            let samples = frame.thinned(SAMPLES);
            Frame {
                noise: Some(Arc::new(RowNoise { samples, variances })),
                ..frame.clone()
            }
        };
        frames.iter().map(noisy).collect()
    }

    /// Mean variances of the sensors' noise in the rows of all runs.
    fn row_variances(&self, frames: &[Frame]) -> ReadingVariances {
        const ROUND: u64 = 2_000_003;
        let noise = self.noise.at_least(&MIN_NOISE);
        let of_run = |(i, frame): (usize, &Frame)| -> ReadingVariances {
            let silent = frame.with_columns(|column| vec![0.0; column.len()]);
            let (mut noisy, mut opposite) = (silent.clone(), silent);
            let rng = &mut stream(self.seed, ROUND, i as u64);
            self.add_noise(&noise, &mut noisy, &mut opposite, rng);
            let squares = |series: &[f64]| frame.rows(series).iter().map(|e| e * e).sum::<f64>();
            let channels = Channels::new(&noisy);
            Sensor::ALL.map(|sensor| channels.series(sensor).map(squares))
        };
        let each: Vec<ReadingVariances> = frames.par_iter().enumerate().map(of_run).collect();
        let rows: usize = frames.iter().map(Frame::row_count).sum();
        std::array::from_fn(|sensor| {
            [0, 1].map(|k| each.iter().map(|run| run[sensor][k]).sum::<f64>() / rows.max(1) as f64)
        })
    }

    /// The simulator without unexplained residuals.
    pub fn sensors_only(&self) -> Self {
        Self {
            unexplained: [0.0; CHANNELS],
            ..self.clone()
        }
    }

    /// A simulation of each run.
    pub fn simulated(&self, frames: &[Frame], model: &ResidualModel, k: u64) -> Vec<Frame> {
        let runs = frames.par_iter().enumerate();
        runs.map(|(i, frame)| self.pair(frame, model, k, i).plus)
            .collect()
    }

    /// Residuals of a simulation of each run.
    pub fn residuals(&self, frames: &[Frame], model: &ResidualModel, k: u64) -> Vec<ChannelRows> {
        residuals(model, &self.simulated(frames, model, k))
    }

    /// The `k`-th pair of simulations of a run, the `i`-th of its set.
    pub fn pair(
        &self,
        frame: &Frame,
        residual_model: &ResidualModel,
        k: u64,
        i: usize,
    ) -> SimulatedPair {
        let mut rng = stream(self.seed, 0x7417 + k, i as u64);
        let rows = residual_model.sample_residuals(frame);
        let truth = truth(frame, residual_model, &rows);
        let (mut plus, mut minus) = (truth.clone(), truth.clone());
        self.add_unexplained(&mut plus, &mut minus, residual_model, &rows, &mut rng);
        self.add_noise(&self.noise, &mut plus, &mut minus, &mut rng);
        SimulatedPair { truth, plus, minus }
    }

    /// Adds the unexplained part of the residuals to one run and subtracts it from the other.
    fn add_unexplained(
        &self,
        plus: &mut Frame,
        minus: &mut Frame,
        residual_model: &ResidualModel,
        rows: &ChannelRows,
        rng: &mut impl Rng,
    ) {
        // Samples next to a gap have no residual.
        let samples: Vec<usize> = plus.samples().collect();
        let n = samples.len();
        let shift = below(rng, n);
        let flip = sign(rng);
        let sled = plus.sled(residual_model.vehicle.sled);
        // A residual is moved to another place: it is scaled by the deviations at both.
        let scales = plus.scales_at(&plus.s);
        let unexplained = |c: usize, k: usize| -> f64 {
            let (from, to) = (samples[(k + shift) % n], samples[k]);
            let scale = |i: usize| scales.get(i).and_then(|s| s.get(c)).copied().unwrap_or(1.0);
            let residual = rows[c].get(from);
            residual.map_or(0.0, |r| {
                flip * self.unexplained[c] * r * scale(to) / scale(from)
            })
        };
        for (k, i) in samples.iter().copied().enumerate() {
            let yaw = unexplained(2, k) / sled.j_zz_kgm2;
            let longitudinal = unexplained(0, k) / sled.mass_kg - sled.accel_y_m * yaw;
            let lateral = unexplained(1, k) / sled.mass_kg + sled.accel_x_m * yaw;
            for (run, sign) in [(&mut *plus, 1.0), (&mut *minus, -1.0)] {
                run.rate_slope[2][i] += sign * yaw;
                run.acceleration[0][i] += sign * longitudinal;
                run.acceleration[1][i] += sign * lateral;
                run.v_slope[i] += sign * unexplained(3, k);
            }
        }
    }

    /// Adds sensor noise to one run and subtracts it from the other.
    fn add_noise(
        &self,
        noise: &SensorNoise,
        plus: &mut Frame,
        minus: &mut Frame,
        rng: &mut impl Rng,
    ) {
        let kernel = signal_kernel(plus.recorded_dt, &self.signals);
        let length = (plus.len() - 1) * kernel.stride + 2 * kernel.margin() + 1;
        let dt = plus.recorded_dt;
        let add = |to: &mut [f64], noise: &[f64], sign: f64| {
            to.iter_mut().zip(noise).for_each(|(x, e)| *x += sign * e);
        };
        for sensor in NOISE_ORDER {
            let column = noise.of(sensor);
            let noise = column.colour.noise(length, dt, rng);
            let noise: Vec<f64> = noise.into_iter().map(|e| column.sd * e).collect();
            let smooth = kernel.smooth(&noise);
            let (_, derivative) = plus.series(sensor);
            let slope = derivative.map_or_else(Vec::new, |_| kernel.slope(&noise));
            for (run, sign) in [(&mut *plus, 1.0), (&mut *minus, -1.0)] {
                let (signal, derivative) = run.series_mut(sensor);
                add(signal, &smooth, sign);
                if let Some(derivative) = derivative {
                    add(derivative, &slope, sign);
                }
            }
        }
    }
}

/// The run with the accelerations that the model predicts from the measured inputs, so that the
/// residuals are zero. Residuals of a delayed sensor are shifted to the time of its reading.
///
/// `rows` are the longitudinal, lateral and yaw residuals at every retained sample.
pub fn truth(frame: &Frame, residual_model: &ResidualModel, rows: &[Vec<f64>]) -> Frame {
    let mut run = frame.clone();
    let sled = frame.sled(residual_model.vehicle.sled);
    let delayed = |sensor: Sensor, residual: Vec<f64>| {
        let delay = residual_model.delay(sensor, &frame.track);
        if delay == 0.0 {
            return residual;
        }
        ahead(&residual, -delay / frame.sample_s())
    };
    let [along, side, yaw, ..] = rows else {
        panic!("rows of three balances");
    };
    let yaw: Vec<f64> = yaw.iter().map(|m| m / sled.j_zz_kgm2).collect();
    // The accelerometer at a lever from the centre of gravity measures the yaw acceleration, too.
    let at_sensor = |lever: f64, rows: &[f64]| -> Vec<f64> {
        let both = rows.iter().zip(&yaw);
        both.map(|(r, yaw)| lever * yaw - r / sled.mass_kg)
            .collect()
    };
    let along = at_sensor(sled.accel_y_m, along);
    let side = at_sensor(-sled.accel_x_m, side);
    let minus_yaw = yaw.iter().map(|yaw| -yaw).collect();
    let [longitudinal, lateral, _] = &mut run.acceleration;
    for (to, change) in [
        (longitudinal, delayed(Sensor::Ax, along)),
        (lateral, delayed(Sensor::Ay, side)),
        (&mut run.rate_slope[2], delayed(Sensor::YawRate, minus_yaw)),
    ] {
        let both = to.iter_mut().zip(change);
        both.for_each(|(x, change)| *x += change);
    }
    if !frame.slope.is_empty() {
        let residual = residual_model.track_residual(&run);
        for (slope, r) in run.v_slope.iter_mut().zip(delayed(Sensor::Speed, residual)) {
            *slope -= r;
        }
    }
    run
}
