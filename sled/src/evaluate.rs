//! A driver's score: energy lost beyond what a straight glide would lose.

use rayon::prelude::*;
use serde::Serialize;

use crate::aero::{along_driving_direction, drag};
use crate::bootstrap::{Summary, summarise};
use crate::friction::Vehicle;
use crate::one_track::forward;
use crate::prepare::Prepared;

/// One run's energies, relative increases and angles.
#[derive(Clone, Debug, Serialize)]
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
    /// Least loss, `E_tot_loss` of a straight glide [J]; negative, as energy is taken from the sled.
    pub e_tot_loss_j: f64,
    /// Relative increase at the front runner.
    pub increase_front: f64,
    /// Relative increase at the rear runner.
    pub increase_rear: f64,
    /// Relative increase of the air's drag.
    pub increase_aero: f64,
    /// Sum of the three: the score, smaller is better.
    pub increase_total: f64,
    /// Steering angle.
    pub steering: Angles,
    /// Slip angle at the front runner.
    pub slip_front: Angles,
    /// Slip angle at the rear runner.
    pub slip_rear: Angles,
    /// Chassis slip angle.
    pub chassis_slip: Angles,
    /// Forces over the run; not part of the report.
    #[serde(skip)]
    pub series: Vec<DrivingForce>,
}

/// Distribution of an angle over one run.
#[derive(Clone, Copy, Debug, Serialize)]
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
    /// `F_x~`: along the driving direction, slips as driven.
    pub actual_n: f64,
    /// `F_x`: the least possible, without slip.
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
/// Forces are those of the friction laws at the measured slips and normal forces; `alpha` is the slip at the centre of
/// gravity for both axles, as in the paper. `ds = v dt` by the trapezoidal rule.
pub fn evaluate(runs: &[Prepared], vehicle: &Vehicle) -> Vec<RunEvaluation> {
    runs.par_iter()
        .map(|run| evaluate_run(run, vehicle))
        .collect()
}

fn evaluate_run(run: &Prepared, vehicle: &Vehicle) -> RunEvaluation {
    let vehicle = &vehicle.on_track(&run.entry.track);
    let sled = &vehicle.sled;
    let mut series = Vec::with_capacity(run.states.len());
    // Ideal loss, and what front, rear and air take beyond it.
    let mut energies = [0.0; 4];
    let mut before: Option<[f64; 4]> = None;
    for state in &run.states {
        let forces = forward(vehicle, state);
        let alpha = state.alpha_cog_rad;
        let along = |force: &[f64; 3]| along_driving_direction(force[0], force[1], alpha);
        let air = |beta: f64| drag(sled, state.v_mps, state.air_density_kgpm3, beta);
        let ideal = [forces.front[0], forces.rear[0], air(0.0)];
        let actual = [along(&forces.front_body), along(&forces.rear), air(-alpha)];
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
        let power = [
            ideal_n * state.v_mps,
            (actual[0] - ideal[0]) * state.v_mps,
            (actual[1] - ideal[1]) * state.v_mps,
            (actual[2] - ideal[2]) * state.v_mps,
        ];
        if let Some(before) = before {
            for i in 0..4 {
                energies[i] += 0.5 * run.dt_s * (before[i] + power[i]);
            }
        }
        before = Some(power);
    }
    let [least, front, rear, aero] = energies;
    let angles = |pick: &dyn Fn(&DrivingForce) -> f64| distribution(series.iter().map(pick));
    let (steering, slip_front) = (angles(&|f| f.delta_rad), angles(&|f| f.alpha_f_rad));
    let (slip_rear, chassis_slip) = (angles(&|f| f.alpha_r_rad), angles(&|f| f.beta_rad));
    RunEvaluation {
        run: run.entry.run.clone(),
        track: run.entry.track.clone(),
        driver: run.entry.driver.clone(),
        driver_class: run.entry.driver_class.clone(),
        session: run.entry.session.clone(),
        time_s: run.states.len() as f64 * run.dt_s,
        e_tot_loss_j: least,
        increase_front: front / least,
        increase_rear: rear / least,
        increase_aero: aero / least,
        increase_total: (front + rear + aero) / least,
        steering,
        slip_front,
        slip_rear,
        chassis_slip,
        series,
    }
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

/// Scores of a group of runs, each with its interval over runs.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// What the runs share: `driver`, `class` or `track`.
    pub by: &'static str,
    /// Its name.
    pub name: String,
    /// The track, where only its runs count.
    pub track: Option<String>,
    /// Number of runs.
    pub runs: usize,
    /// Relative increase at the front runner.
    pub increase_front: Summary,
    /// Relative increase at the rear runner.
    pub increase_rear: Summary,
    /// Relative increase of the air's drag.
    pub increase_aero: Summary,
    /// The score.
    pub increase_total: Summary,
    /// Share of steering above 2 degrees.
    pub steering_above_2deg: Summary,
    /// Share of steering above 4 degrees.
    pub steering_above_4deg: Summary,
    /// Share of front slip above 2 degrees.
    pub slip_front_above_2deg: Summary,
    /// Share of rear slip above 2 degrees.
    pub slip_rear_above_2deg: Summary,
}

/// Groups by driver and by class, on each track and over all, and by track; in the order of first appearance.
pub fn groups(runs: &[RunEvaluation], seed: u64) -> Vec<Group> {
    let tracks = distinct(runs, |run| &run.track);
    let mut places: Vec<Option<&str>> = vec![None];
    if tracks.len() > 1 {
        places.extend(tracks.iter().map(|track| Some(*track)));
    }
    let mut groups = Vec::new();
    for place in places {
        let here: Vec<&RunEvaluation> = runs
            .iter()
            .filter(|run| place.is_none_or(|track| run.track == track))
            .collect();
        for (by, key) in [
            (
                "driver",
                (|run| &run.driver) as fn(&RunEvaluation) -> &String,
            ),
            ("class", |run| &run.driver_class),
        ] {
            for name in distinct(runs, key) {
                let of: Vec<&RunEvaluation> = here
                    .iter()
                    .copied()
                    .filter(|run| key(run) == name)
                    .collect();
                groups.extend(group(by, name, place, &of, seed));
            }
        }
    }
    for track in tracks {
        let of: Vec<&RunEvaluation> = runs.iter().filter(|run| run.track == track).collect();
        groups.extend(group("track", track, None, &of, seed));
    }
    groups
}

/// Names in the order of their first run.
pub fn distinct(runs: &[RunEvaluation], key: fn(&RunEvaluation) -> &String) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for run in runs {
        let name = key(run).as_str();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn group(
    by: &'static str,
    name: &str,
    track: Option<&str>,
    runs: &[&RunEvaluation],
    seed: u64,
) -> Option<Group> {
    if runs.is_empty() {
        return None;
    }
    let of = |pick: fn(&RunEvaluation) -> f64| {
        let values: Vec<f64> = runs.iter().map(|run| pick(run)).collect();
        summarise(&values, seed)
    };
    Some(Group {
        by,
        name: name.to_string(),
        track: track.map(str::to_string),
        runs: runs.len(),
        increase_front: of(|run| run.increase_front),
        increase_rear: of(|run| run.increase_rear),
        increase_aero: of(|run| run.increase_aero),
        increase_total: of(|run| run.increase_total),
        steering_above_2deg: of(|run| run.steering.share_above_2deg),
        steering_above_4deg: of(|run| run.steering.share_above_4deg),
        slip_front_above_2deg: of(|run| run.slip_front.share_above_2deg),
        slip_rear_above_2deg: of(|run| run.slip_rear.share_above_2deg),
    })
}
