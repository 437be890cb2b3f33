//! Validation of the friction model by measured runs: the lateral force at the centre of gravity.

use std::ops::Range;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::with_own_contacts;
use crate::friction::Braghin;
use crate::model::vehicle::Vehicle;
use crate::motion::balance::{Balance, BalanceResidual};
use crate::motion::one_track::{forward, forward_braghin, resultant};
use crate::motion::state::{AxleForces, Motion, State};
use crate::series::{distinct, root_mean_square as rms};
use crate::signals::prepare::Prepared;

/// One run's lateral force, measured and modelled.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct RunValidation {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: String,
    /// Driver.
    pub driver: String,
    /// Session.
    pub session: String,
    /// Root mean square error of the model [N].
    pub rmse_n: f64,
    /// Root mean square error of Braghin's law with its published parameters [N].
    pub rmse_braghin_n: f64,
    /// Root mean square residuals of all balances.
    pub left_rms: BalanceResidual,
    /// Stretches with the largest differences between model and measurement, largest first.
    pub largest: Vec<Disagreement>,
    /// The lateral force over time; not part of the report.
    #[serde(skip)]
    pub series: Vec<LateralForce>,
    /// Stretches of `series` without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
}

/// A stretch where model and measurement differ.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Disagreement {
    /// Time [s].
    pub t_s: f64,
    /// Distance [m].
    pub s_m: f64,
    /// Root mean square difference over half a second [N].
    pub rms_n: f64,
    /// Ratio of `rms_n` to the root mean square error of the run.
    pub times_rmse: f64,
}

/// Lateral force at the centre of gravity at one sample [N].
#[derive(Clone, Copy, Debug)]
pub struct LateralForce {
    /// Time [s].
    pub t_s: f64,
    /// Distance [m].
    pub s_m: f64,
    /// From the measured acceleration.
    pub measured_n: f64,
    /// From the friction model.
    pub model_n: f64,
    /// From Braghin's law.
    pub braghin_n: f64,
}

/// Root mean square errors of the runs of one track.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct TrackValidation {
    /// Track.
    pub track: String,
    /// Number of runs.
    pub runs: usize,
    /// Root mean square error of the model over all samples [N].
    pub rmse_n: f64,
    /// Root mean square error of Braghin's law over all samples [N].
    pub rmse_braghin_n: f64,
}

/// Compares every run, in parallel and in order.
///
/// The measured force is `m a_y` at the centre of gravity. The modelled force is the sum of both
/// runners' forces in the body frame and the side force of the air, from slips and normal forces
/// alone.
pub fn validate(runs: &[Prepared], vehicle: &Vehicle) -> Vec<RunValidation> {
    runs.par_iter()
        .map(|run| validate_run(run, vehicle))
        .collect()
}

fn validate_run(run: &Prepared, vehicle: &Vehicle) -> RunValidation {
    let vehicle = &with_own_contacts(run, vehicle);
    let sled = &vehicle.sled;
    let compared = |(state, motion): (&State, &Motion)| {
        let lateral = |forces: &AxleForces| resultant(sled, state, forces).fy_n;
        LateralForce {
            t_s: state.t_s,
            s_m: state.s_m,
            measured_n: sled.mass_kg * motion.accel_mps2[1],
            model_n: lateral(&forward(vehicle, state)),
            braghin_n: lateral(&forward_braghin(vehicle, &Braghin::PUBLISHED, state)),
        }
    };
    let instants = run.states.iter().zip(&run.motions);
    let series: Vec<LateralForce> = instants.map(compared).collect();
    let rmse_n = rms(series.iter().map(|f| f.model_n - f.measured_n));
    RunValidation {
        run: run.entry.run.clone(),
        track: run.entry.track.clone(),
        driver: run.entry.driver.clone(),
        session: run.entry.session.clone(),
        rmse_n,
        rmse_braghin_n: rms(series.iter().map(|f| f.braghin_n - f.measured_n)),
        left_rms: root_mean_square(&residuals(run, vehicle)),
        largest: largest_disagreements(&series, run, rmse_n),
        pieces: run.pieces.clone(),
        series,
    }
}

/// Up to five stretches of half a second without a gap, at least two seconds apart, with at least
/// twice the root mean square error `rmse` of the run.
fn largest_disagreements(series: &[LateralForce], run: &Prepared, rmse: f64) -> Vec<Disagreement> {
    let window = ((0.5 / run.dt_s) as usize).clamp(1, series.len());
    let mut sums = vec![0.0];
    for f in series {
        sums.push(sums[sums.len() - 1] + (f.model_n - f.measured_n).powi(2));
    }
    let starts = |piece: &Range<usize>| piece.start..(piece.end + 1).saturating_sub(window);
    let mut candidates: Vec<Disagreement> = run
        .pieces
        .iter()
        .flat_map(starts)
        .map(|start| {
            let mean_square = (sums[start + window] - sums[start]) / window as f64;
            let rms_n = mean_square.max(0.0).sqrt();
            let middle = &series[start + window / 2];
            Disagreement {
                t_s: middle.t_s,
                s_m: middle.s_m,
                rms_n,
                times_rmse: rms_n / rmse,
            }
        })
        .filter(|d| d.times_rmse >= 2.0)
        .collect();
    candidates.sort_by(|a, b| b.rms_n.total_cmp(&a.rms_n));
    let mut largest: Vec<Disagreement> = Vec::new();
    for candidate in candidates {
        if largest.len() == 5 {
            break;
        }
        if largest.iter().all(|d| (d.t_s - candidate.t_s).abs() >= 2.0) {
            largest.push(candidate);
        }
    }
    largest
}

/// Root mean square errors by track, in the order of the tracks' first runs.
pub fn by_track(runs: &[RunValidation]) -> Vec<TrackValidation> {
    let validation = |track: &str| {
        let on_track: Vec<&RunValidation> = runs.iter().filter(|run| run.track == track).collect();
        let samples: f64 = on_track.iter().map(|run| run.series.len() as f64).sum();
        let pooled = |rmse: fn(&RunValidation) -> f64| {
            let squares = on_track
                .iter()
                .map(|run| run.series.len() as f64 * rmse(run).powi(2));
            (squares.sum::<f64>() / samples).sqrt()
        };
        TrackValidation {
            track: track.to_string(),
            runs: on_track.len(),
            rmse_n: pooled(|run| run.rmse_n),
            rmse_braghin_n: pooled(|run| run.rmse_braghin_n),
        }
    };
    let tracks = distinct(runs.iter().map(|run| run.track.as_str()));
    tracks.into_iter().map(validation).collect()
}

/// Residuals of the balances of one run, one per state.
pub fn residuals(run: &Prepared, vehicle: &Vehicle) -> Vec<BalanceResidual> {
    let vehicle = &with_own_contacts(run, vehicle);
    let residual = |(state, motion): (&State, &Motion)| {
        let at = Balance::new(&vehicle.sled, state, motion);
        at.residual(&at.forces(vehicle, &at.laws(vehicle)))
    };
    let instants = run.states.iter().zip(&run.motions);
    instants.map(residual).collect()
}

/// Root mean square of each balance over the samples; 0 without samples.
pub fn root_mean_square(residuals: &[BalanceResidual]) -> BalanceResidual {
    if residuals.is_empty() {
        return BalanceResidual::default();
    }
    BalanceResidual {
        along_n: rms(residuals.iter().map(|l| l.along_n)),
        side_n: rms(residuals.iter().map(|l| l.side_n)),
        yaw_nm: rms(residuals.iter().map(|l| l.yaw_nm)),
    }
}

/// [`root_mean_square`] of the residuals of all runs, in parallel.
pub fn balance_residuals(runs: &[Prepared], vehicle: &Vehicle) -> BalanceResidual {
    let each: Vec<Vec<BalanceResidual>> =
        runs.par_iter().map(|run| residuals(run, vehicle)).collect();
    root_mean_square(&each.concat())
}
