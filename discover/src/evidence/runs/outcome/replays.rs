//! Replays of the runs: simulations from each run's start with its steering.
//!
//! The replay compares time, speed and yaw rate over distance. The forces determine friction with
//! the errors of the accelerometer and the mass; a replay has neither. The multiplier x of friction
//! that is written is therefore the one at which the training runs are replayed best. With q_g the
//! sum of squares of the speed's difference over the runs of session g, and central differences
//! about the fit,
//!
//! ```text
//! x = 1 - sum_g q_g' / sum_g q_g''
//! ```
//!
//! The same sums without a session belong to the fit without it, and the scatter of these x gives a
//! variance V (the jackknife). Sessions have their own ice and wind: a change d from the stated
//! friction is written as `d max(0, 1 - V/d^2)`, its estimate of least expected error.
//!
//! Source: L. Breiman, Better subset regression using the nonnegative garrote, Technometrics 37
//! (1995) 373.

use std::collections::BTreeMap;
use std::sync::Arc;

use kufe_sled::{
    Inputs, Model, SimulateOptions, Track, TrackShape, Vehicle, refuse_effects, replay,
};
use rayon::prelude::*;

use crate::evidence::runs::campaign::{Campaign, RunFit, locked, sensor_effects};
use crate::evidence::runs::model::residual_model::{BOUNDS, ResidualModel};
use crate::evidence::runs::outcome::next_model::next_model;
use crate::null::clusters::members;

/// Columns of a replay that are compared, and their units.
const REPLAYED: [(&str, &str); 3] = [("t_s", "s"), ("v_mps", "m/s"), ("yaw_rate_radps", "rad/s")];
/// Index of the speed among these columns.
const SPEED: usize = 1;
/// Time step [s]: the differences of time, of 5 ms, change by 7 µs from half of it.
const STEP_S: f64 = 1e-2;
/// Speed below which a run counts as at rest [m/s].
const REST_MPS: f64 = 1.0;
/// Rate of a replay's output [Hz].
const RATE_HZ: f64 = 100.0;
/// Relative step of the friction for differences of its replays: speeds are linear in it beyond.
const FRICTION_STEP: f64 = 0.1;
/// Largest number of Newton steps if the friction changes by more than `FRICTION_STEP`.
const FRICTION_ROUNDS: usize = 3;

/// Sums of squares of one quantity with their numbers of values, by piece.
pub struct Squares {
    pub name: String,
    pub unit: &'static str,
    /// Variance of the sensor's noise; 0 if the squares include it.
    pub noise: f64,
    /// Sum of squares and number of values of each piece.
    pub pieces: Vec<[f64; 2]>,
}

impl Squares {
    pub fn mean(&self) -> f64 {
        let [sum, count] = [0, 1].map(|k| self.pieces.iter().map(|p| p[k]).sum::<f64>());
        sum / count.max(1.0)
    }

    pub fn rms(&self) -> f64 {
        self.mean().sqrt()
    }
}

/// A replay of one run by column of [`REPLAYED`].
struct ReplayedRun {
    /// Mean squares of the differences from the recorded run.
    mean_squares: [f64; 3],
    /// Standard deviations of the differences by the noise of the sensors.
    noise_sd: [f64; 3],
}

/// Factor on friction at which runs are replayed best.
struct FrictionFactor<'a> {
    by: f64,
    /// The factor without each session.
    without: BTreeMap<&'a str, f64>,
}

impl Campaign<'_> {
    /// The vehicle of a model for replays, read back from its text by the readers of the simulation
    /// commands.
    pub fn read_back(&self, model: &ResidualModel, already: usize) -> Result<Vehicle, String> {
        let text = next_model(self.model, model, already).to_toml();
        let read = || -> Result<Vehicle, kufe_sled::Error> {
            let mut model = Model::from_toml(&text, "model.next.toml")?;
            model.folder.clone_from(&self.model.folder);
            let mut vehicle = Vehicle::with_effects(&model)?;
            for frame in self.training.iter().chain(&self.held_out) {
                let run = format!("run {}", frame.name);
                refuse_effects(&vehicle.effects, &frame.unstated_conditions(), &run)?;
            }
            // A contact that varies from run to run is not part of a replay.
            vehicle.effects.active.retain(|effect| !effect.varies());
            Ok(vehicle)
        };
        read().map_err(|error| format!("it cannot be simulated: {error}"))
    }

    /// Indices of the replayed runs, and the squares of their replays' differences, one piece per
    /// session. Unless runs are `stated`, all possible ones are replayed: runs on a track without a
    /// table, and runs that all estimates are fitted to, are omitted.
    pub fn replay_squares<'v>(
        &self,
        vehicle_of: impl Fn(usize) -> &'v Vehicle + Sync,
        stated: Option<&[usize]>,
    ) -> Result<(Vec<usize>, Vec<Squares>), String> {
        let tracks: Vec<Track> = self.data.downhill_tracks();
        let all = &self.data.runs;
        let shapes: Vec<_> = tracks.iter().map(|t| (t, TrackShape::new(t))).collect();
        let on_track = |i: &usize| tracks.iter().any(|t| t.name == all[*i].entry.track);
        // Training runs are replayed with the estimates without their session; with a single
        // session there are no such estimates.
        let sessions = members(self.training.iter().map(|frame| frame.session.as_str()));
        let fitted = |i: &usize| self.data.segmented || self.data.locked.training.contains(i);
        let possible = || {
            let runs = (0..all.len()).filter(on_track);
            runs.filter(|i| sessions.len() > 1 || !fitted(i)).collect()
        };
        let runs: Vec<usize> = stated.map_or_else(possible, <[usize]>::to_vec);
        let of_run = |i: &usize| {
            let track = shapes.iter().find(|(t, _)| t.name == all[*i].entry.track);
            let (track, shape) = track.expect("runs without a track are filtered out");
            self.replay_of(*i, vehicle_of(*i), track, shape)
        };
        let tried: Vec<Result<ReplayedRun, String>> = runs.par_iter().map(of_run).collect();
        let (mut replayed, mut each) = (Vec::new(), Vec::new());
        for (run, tried) in runs.into_iter().zip(tried) {
            match tried {
                Ok(one) => {
                    replayed.push(run);
                    each.push(one);
                }
                Err(error) if stated.is_some() => return Err(error),
                Err(_) => {}
            }
        }
        let sessions = members(replayed.iter().map(|i| all[*i].entry.session.as_str()));
        let of_column = |(k, (column, unit)): (usize, &(&str, &'static str))| {
            let variances = each.iter().map(|one| one.noise_sd[k].powi(2));
            let of_session = |runs: &Vec<usize>| {
                let squares = runs.iter().map(|run| each[*run].mean_squares[k]);
                [squares.sum(), runs.len() as f64]
            };
            Squares {
                name: format!("replay {column}"),
                unit,
                noise: variances.sum::<f64>() / each.len().max(1) as f64,
                pieces: sessions.values().map(of_session).collect(),
            }
        };
        let columns = REPLAYED.iter().enumerate().filter(|_| !each.is_empty());
        let columns = columns.map(of_column).collect();
        Ok((replayed, columns))
    }

    /// The replay of a run with a vehicle.
    fn replay_of(
        &self,
        index: usize,
        vehicle: &Vehicle,
        track: &Track,
        shape: &TrackShape,
    ) -> Result<ReplayedRun, String> {
        let run = &self.data.runs[index];
        let name = &run.entry.run;
        let failed =
            |error: kufe_sled::Error| format!("run {name} cannot be replayed with it: {error}");
        let inputs = self.replay_inputs(index, vehicle, track).map_err(failed)?;
        let options = SimulateOptions {
            step_s: STEP_S,
            rate_hz: RATE_HZ,
            conditions: run.entry.conditions,
            ..SimulateOptions::default()
        };
        let replay = replay(&inputs, vehicle, shape, &options).map_err(failed)?;
        if let Some(stopped) = replay.stopped {
            return Err(format!("run {name} stops in its replay: {stopped}"));
        }
        let [speed_sd, _, yaw_rate_sd, _] = inputs.noise_sd;
        // An error of the speed shifts the time of passing.
        let time_sd: f64 = run.columns.get("v_mps").map_or(0.0, |speeds| {
            let moving = speeds.iter().filter(|v| **v > REST_MPS);
            moving.map(|v| run.dt_s * speed_sd / v).sum()
        });
        Ok(ReplayedRun {
            mean_squares: REPLAYED.map(|(column, _)| {
                let difference = replay.differences.iter().find(|d| d.column == column);
                difference.map_or(0.0, |d| d.rms * d.rms)
            }),
            noise_sd: [time_sd, speed_sd, yaw_rate_sd],
        })
    }

    /// The inputs of a run's replay, with the vehicle's effects on sensors taken out.
    fn replay_inputs(
        &self,
        run: usize,
        vehicle: &Vehicle,
        track: &Track,
    ) -> Result<Arc<Inputs>, kufe_sled::Error> {
        let own = sensor_effects(&vehicle.effects);
        if let Some((known, inputs)) = locked(&self.replay_inputs).get(&run)
            && *known == own
        {
            return Ok(inputs.clone());
        }
        let inputs = Inputs::of(&self.data.runs[run], vehicle, track.s_m[0])?;
        let inputs = Arc::new(inputs);
        locked(&self.replay_inputs).insert(run, (own, inputs.clone()));
        Ok(inputs)
    }

    /// The factor on friction at which these runs are replayed best, by Newton's method; `squares` are
    /// the squares of the speed's difference at a factor, by session. `None` if a run cannot be
    /// replayed or the squares have no minimum.
    fn friction_factor(
        &self,
        runs: &[usize],
        squares: impl Fn(f64) -> Result<Vec<[f64; 2]>, String>,
    ) -> Option<FrictionFactor<'_>> {
        let of_run = |run: &usize| self.data.runs[*run].entry.session.as_str();
        let sessions = members(runs.iter().map(of_run));
        let mut by = 1.0;
        let mut without = BTreeMap::new();
        for _ in 0..FRICTION_ROUNDS {
            let step = FRICTION_STEP * by;
            let [Ok(below), Ok(here), Ok(above)] = [by - step, by, by + step].map(&squares) else {
                return None;
            };
            // First and second differences of a session's squares.
            let of_session = |((below, here), above): ((&[f64; 2], &[f64; 2]), &[f64; 2])| {
                [
                    0.5 * (above[0] - below[0]),
                    above[0] - 2.0 * here[0] + below[0],
                ]
            };
            let all = below.iter().zip(&here).zip(&above);
            let differences: Vec<[f64; 2]> = all.map(of_session).collect();
            let [slope, curvature] =
                [0, 1].map(|k| differences.iter().map(|one| one[k]).sum::<f64>());
            if curvature <= 0.0 {
                return None;
            }
            let best = |slope: f64, curvature: f64| by - step * slope / curvature;
            // A single session cannot be left out.
            let left_out = |[own, bent]: &[f64; 2]| match curvature - bent {
                rest if rest > 0.0 => best(slope - own, rest),
                _ => best(slope, curvature),
            };
            let each = differences.iter().map(left_out);
            without = sessions.keys().copied().zip(each).collect();
            let moved = best(slope, curvature) - by;
            by += moved;
            if moved.abs() < step {
                break;
            }
        }
        Some(FrictionFactor { by, without })
    }

    /// The fit with the friction at which the training runs among `replayed` are replayed best,
    /// shrunk towards the stated friction by the scatter between sessions.
    ///
    /// Unchanged if friction is not fitted or a run cannot be replayed.
    pub fn with_replayed_friction(&self, mut fit: RunFit, replayed: &[usize]) -> RunFit {
        let training = &self.data.locked.training;
        let learned = |run: &usize| training.contains(run);
        let runs: Vec<usize> = replayed.iter().copied().filter(learned).collect();
        if !self.free.contains(&0) || runs.is_empty() {
            return fit;
        }
        let squares = |by: f64| -> Result<Vec<[f64; 2]>, String> {
            let mut model = fit.final_model.clone();
            model.base[0] *= by;
            let vehicle = self.read_back(&model, fit.already())?;
            let (_, replays) = self.replay_squares(|_| &vehicle, Some(&runs))?;
            Ok(replays[SPEED].pieces.clone())
        };
        let Some(FrictionFactor { by, without }) = self.friction_factor(&runs, squares) else {
            return fit;
        };
        let (own, stated) = (fit.final_model.base[0], self.given.base[0]);
        let n = without.len() as f64;
        let mean = without.values().sum::<f64>() / n;
        let squares: f64 = without.values().map(|by| (by - mean).powi(2)).sum();
        let variance = (n - 1.0) / n * squares * own * own;
        let written = |friction: f64| -> f64 {
            let off = friction - stated;
            let share = (1.0 - variance / (off * off).max(f64::MIN_POSITIVE)).max(0.0);
            (stated + off * share).clamp(BOUNDS[0], BOUNDS[1])
        };
        for (of_session, model) in &mut fit.left_out {
            let run = of_session
                .first()
                .map(|run| &self.data.runs[training[*run]]);
            let by_others = run.and_then(|run| without.get(run.entry.session.as_str()));
            model.base[0] = written(model.base[0] * by_others.copied().unwrap_or(by));
        }
        let friction = written(own * by);
        fit.final_model.base[0] = friction;
        let number = self.free.iter().position(|b| *b == 0);
        if let Some(estimate) = number.and_then(|k| fit.estimates.get_mut(k)) {
            *estimate = estimate.stated_as(friction);
        }
        fit
    }
}
