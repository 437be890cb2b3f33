//! A driver's score: energy lost in addition to the loss of a straight glide.

use std::ops::Range;

use crate::effects::Forces;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::with_own_contacts;
use crate::evaluate::track_loss::{Stretches, TrackLoss, add_loss, seconds_per_joule};
use crate::evaluate::validate::{residuals, root_mean_square};
use crate::model::vehicle::Vehicle;
use crate::motion::aero::{along_driving_direction, drag};
use crate::motion::balance::{Balance, BalanceResidual};
use crate::motion::one_track::forces_at;
use crate::motion::state::{AxleForces, Motion};
use crate::signals::prepare::Prepared;

/// One run's energies, relative increases and angles.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct RunEvaluation {
    /// Name of the run.
    pub run: String,
    /// Track.
    pub track: String,
    /// Driver.
    pub driver: String,
    /// Driver's class.
    pub driver_class: String,
    /// Session.
    pub session: String,
    /// Run time [s].
    pub time_s: f64,
    /// Loss of a straight glide, the smallest possible, `E_tot_loss` [J]; negative, since the sled
    /// loses energy.
    pub e_tot_loss_j: f64,
    /// Relative increase at the front runner.
    pub increase_front: f64,
    /// Relative increase at the rear runner.
    pub increase_rear: f64,
    /// Relative increase of the air's drag.
    pub increase_aero: f64,
    /// Sum of the three: the score, smaller is better.
    pub increase_total: f64,
    /// Root mean square residuals of the balances: the quality of the model for this run.
    pub left_rms: BalanceResidual,
    /// Steering angle.
    pub steering: Angles,
    /// Slip angle at the front runner.
    pub slip_front: Angles,
    /// Slip angle at the rear runner.
    pub slip_rear: Angles,
    /// Chassis slip angle.
    pub chassis_slip: Angles,
    /// Losses by stretch of the track, with the time that they cost.
    #[serde(default)]
    pub losses: Vec<TrackLoss>,
    /// Forces over the run; not part of the report.
    #[serde(skip)]
    pub series: Vec<DrivingForce>,
    /// Stretches of `series` without a gap.
    #[serde(skip)]
    pub pieces: Vec<Range<usize>>,
}

/// Distribution of an angle over one run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Angles {
    /// Root mean square [rad].
    pub rms_rad: f64,
    /// Median magnitude [rad].
    pub median_rad: f64,
    /// Largest magnitude [rad].
    pub largest_rad: f64,
    /// Share of samples whose magnitude is above 2 degrees.
    pub share_above_2deg: f64,
    /// Share of samples whose magnitude is above 4 degrees.
    pub share_above_4deg: f64,
}

/// Forces against the motion at one sample [N], all negative.
#[derive(Clone, Copy, Debug)]
pub struct DrivingForce {
    /// Time [s].
    pub t_s: f64,
    /// Distance [m].
    pub s_m: f64,
    /// `F_x~`: along the driving direction, with the actual slips.
    pub actual_n: f64,
    /// `F_x`: the smallest possible, without slip.
    pub ideal_n: f64,
    /// Slip angle at the front runner [rad].
    pub alpha_f_rad: f64,
    /// Slip angle at the rear runner [rad].
    pub alpha_r_rad: f64,
    /// Steering angle [rad].
    pub delta_rad: f64,
    /// Chassis slip angle [rad].
    pub beta_rad: f64,
}

/// Evaluates every run, in parallel and in order.
///
/// ```text
/// E_tot_loss    = int F_x,f + F_x,r + F_x,aero ds
/// Delta E_f     = int F_x~,f0 - F_x,f ds / E_tot_loss,     F_x~ = F_x cos(alpha) - F_y sin(alpha)
/// Delta E_r     = int F_x~,r - F_x,r ds / E_tot_loss
/// Delta E_aero  = int F_x~,aero - F_x,aero ds / E_tot_loss
/// ```
///
/// Forces of effects on the body count as air drag. Forces are those of the friction laws at the
/// measured slips and normal forces; `alpha` is the slip at the centre of gravity for both axles,
/// as in the paper. `ds = v dt` by the trapezoidal rule, over the stretches without gaps. A gap
/// contributes to neither loss, so that the increases are those of the recorded part.
pub fn evaluate(runs: &[Prepared], vehicle: &Vehicle) -> Vec<RunEvaluation> {
    runs.par_iter()
        .map(|run| evaluate_run(run, vehicle))
        .collect()
}

fn evaluate_run(run: &Prepared, vehicle: &Vehicle) -> RunEvaluation {
    let vehicle = &with_own_contacts(run, vehicle);
    let sled = &vehicle.sled;
    let mut series = Vec::with_capacity(run.states.len());
    // Power of a straight glide, and the additional power at front, rear and air [W].
    let mut powers: Vec<[f64; 4]> = Vec::with_capacity(run.states.len());
    for state in &run.states {
        let at = Balance::new(sled, state, &Motion::default());
        let forces = forces_at(vehicle, &at);
        let straight = straight_glide(vehicle, &at, &forces);
        let alpha = state.alpha_cog_rad;
        let along = |force: &[f64; 3]| along_driving_direction(force[0], force[1], alpha);
        let air = |beta: f64| drag(sled, state.v_mps, state.air_density_kgpm3, beta);
        let [ideal_front, ideal_rear] = straight.along;
        let ideal = [ideal_front, ideal_rear, air(0.0) + straight.body_along];
        let body = along(&[forces.body[0], forces.body[1], 0.0]);
        let [front, rear] = [&forces.front_body, &forces.rear].map(along);
        let actual = [front, rear, air(-alpha) + body];
        let ideal_n: f64 = ideal.iter().sum();
        series.push(DrivingForce {
            t_s: state.t_s,
            s_m: state.s_m,
            actual_n: actual.iter().sum(),
            ideal_n,
            alpha_f_rad: state.alpha_f_rad,
            alpha_r_rad: state.alpha_r_rad,
            delta_rad: state.delta_rad,
            beta_rad: -alpha,
        });
        let [front, rear, aero] = std::array::from_fn(|k| actual[k] - ideal[k]);
        powers.push([ideal_n, front, rear, aero].map(|force: f64| force * state.v_mps));
    }
    let delay = seconds_per_joule(sled, &run.states);
    let (mut energies, mut losses) = ([0.0; 4], Stretches::new());
    for i in run.pieces.iter().flat_map(|p| p.start + 1..p.end) {
        let [before, power] = [powers[i - 1], powers[i]];
        let work: [f64; 4] = std::array::from_fn(|k| 0.5 * run.dt_s * (before[k] + power[k]));
        energies = std::array::from_fn(|k| energies[k] + work[k]);
        let lost = [-work[1], -work[2], -work[3]];
        let s_m = 0.5 * (run.states[i - 1].s_m + run.states[i].s_m);
        add_loss(&mut losses, s_m, lost, 0.5 * (delay[i - 1] + delay[i]));
    }
    let [least, front, rear, aero] = energies;
    let angles = |pick: fn(&DrivingForce) -> f64| distribution(series.iter().map(pick));
    RunEvaluation {
        run: run.entry.run.clone(),
        track: run.entry.track.clone(),
        driver: run.entry.driver.clone(),
        driver_class: run.entry.driver_class.clone(),
        session: run.entry.session.clone(),
        time_s: run.span_s(),
        e_tot_loss_j: least,
        increase_front: front / least,
        increase_rear: rear / least,
        increase_aero: aero / least,
        increase_total: (front + rear + aero) / least,
        left_rms: root_mean_square(&residuals(run, vehicle)),
        steering: angles(|f| f.delta_rad),
        slip_front: angles(|f| f.alpha_f_rad),
        slip_rear: angles(|f| f.alpha_r_rad),
        chassis_slip: angles(|f| f.beta_rad),
        losses: losses.into_values().collect(),
        series,
        pieces: run.pieces.clone(),
    }
}

/// Forces along the sled in a straight glide, without slip, steering and roll-split, with effects.
///
/// Without effects these are the base laws' forces along the runners at the actual slips, as in the
/// paper.
fn straight_glide(vehicle: &Vehicle, at: &Balance, forces: &AxleForces) -> Forces {
    if vehicle.effects.is_empty() {
        return Forces {
            along: [forces.front[0], forces.rear[0]],
            ..Forces::default()
        };
    }
    let laws = at.laws(vehicle);
    let mut straight = Forces {
        across: [0.0; 2],
        ..laws.forces
    };
    let seen = crate::effects::State {
        slip: [0.0; 2],
        slip_rate: [0.0; 2],
        chassis_slip: 0.0,
        steering: 0.0,
        roll_split: 0.0,
        ..at.seen(vehicle, laws.load_n)
    };
    vehicle.effects.act(&seen, &mut straight);
    straight
}

fn distribution(values: impl Iterator<Item = f64>) -> Angles {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let n = sizes.len() as f64;
    let above = |degrees: f64| {
        let limit = degrees.to_radians();
        (sizes.len() - sizes.partition_point(|v| *v <= limit)) as f64 / n
    };
    Angles {
        rms_rad: (sizes.iter().map(|v| v * v).sum::<f64>() / n).sqrt(),
        median_rad: sizes[sizes.len() / 2],
        largest_rad: sizes[sizes.len() - 1],
        share_above_2deg: above(2.0),
        share_above_4deg: above(4.0),
    }
}
