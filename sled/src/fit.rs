//! Lateral friction of both runners from measured runs.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::{find_contacts, with_own_contacts};
use crate::error::Error;
use crate::evaluate::validate::balance_residuals;
use crate::friction::{CONFIDENCE, LateralFit, LateralFitOptions, LateralSample, fit_lateral};
use crate::model::model_toml::Model;
use crate::model::vehicle::{RunnerFriction, Vehicle};
use crate::motion::balance::BalanceResidual;
use crate::motion::one_track::{inverse, share_of_laws};
use crate::signals::prepare::Prepared;

/// Fits both runners to prepared runs.
///
/// The forces come from [`crate::one_track::inverse`], which takes the longitudinal friction from
/// `vehicle`; of its lateral laws only C is used, where the data do not determine it. The fit
/// corrects for the slip noise that each run states. With `leave_out_contacts`, stretches with a
/// force from outside, such as a wall, are found ([`find_contacts`]) and excluded.
///
/// # Errors
/// [`Error::Undetermined`] where the data do not determine a runner's stiffness; [`Error::TooFew`]
/// without runs.
pub fn fit(
    runs: &[Prepared],
    vehicle: &Vehicle,
    leave_out_contacts: bool,
) -> Result<FitResult, Error> {
    if runs.is_empty() {
        return Err(Error::too_few("runs to fit", 0, 1));
    }
    let slip_sd = |axle: usize| {
        let squares: f64 = runs.iter().map(|run| run.slip_sd_rad[axle].powi(2)).sum();
        (squares / runs.len() as f64).sqrt()
    };
    let fit_one = |samples: &[LateralSample], runner: &RunnerFriction, axle: usize| {
        let options = LateralFitOptions {
            c: runner.lateral.c,
            slip_sd: slip_sd(axle),
            ..LateralFitOptions::default()
        };
        fit_lateral(samples, &options)
    };
    let both = |contacts: &[Vec<bool>], fitted: &Vehicle| {
        let ([front, rear], excluded) = lateral_samples(runs, fitted, contacts);
        let (front, rear) = rayon::join(
            || fit_one(&front, &vehicle.front, 0),
            || fit_one(&rear, &vehicle.rear, 1),
        );
        Ok::<_, Error>((front?, rear?, excluded))
    };
    let (mut front, mut rear, excluded) = both(&[], vehicle)?;
    let mut contacts = 0;
    let mut marked = Vec::new();
    // The first fit is biased by the contacts, so that they are searched for again with the second
    // fit. Effects that scale with the stiffness of the laws use the stiffness of the previous
    // round.
    let refine = leave_out_contacts || !vehicle.effects.is_empty();
    for _ in 0..if refine { 2 } else { 0 } {
        let fitted = vehicle.with_lateral(front.law(), rear.law());
        if leave_out_contacts {
            marked = find_contacts(runs, &fitted);
            contacts = marked.iter().flatten().filter(|marked| **marked).count();
        }
        if contacts == 0 && vehicle.effects.is_empty() {
            break;
        }
        (front, rear, _) = both(&marked, &fitted)?;
    }
    let fitted = vehicle.with_lateral(front.law(), rear.law());
    Ok(FitResult {
        front,
        rear,
        confidence: CONFIDENCE,
        runs: runs.iter().map(|run| run.entry.run.clone()).collect(),
        samples: runs.iter().map(|run| run.states.len()).sum(),
        excluded_roll_acceleration: excluded,
        excluded_contacts: contacts,
        balances_left_rms: balance_residuals(runs, &fitted),
        identifiability: IDENTIFIABILITY.to_owned(),
    })
}

impl FitResult {
    /// The model with the fitted lateral laws.
    pub fn applied_to(&self, model: &Model) -> Model {
        let mut fitted = model.clone();
        fitted.friction.front = self.front.law();
        fitted.friction.rear = self.rear.law();
        fitted
    }
}

const IDENTIFIABILITY: &str = "mu_y and zeta_y act only as their product mu_zeta. At the slips driven, mu_zeta and c act almost only as mu_zeta_c: use this product and k_n_per_rad. If c_held is true, mu_zeta depends on the fixed c. e was predefined.";

/// The lateral friction of both runners as written to `fit.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FitResult {
    /// Front runner.
    pub front: LateralFit,
    /// Rear runner.
    pub rear: LateralFit,
    /// Confidence level of the intervals.
    pub confidence: f64,
    /// Runs used.
    pub runs: Vec<String>,
    /// Number of samples before exclusions.
    pub samples: usize,
    /// Samples excluded for their roll acceleration.
    pub excluded_roll_acceleration: usize,
    /// Samples excluded because of a force from outside.
    pub excluded_contacts: usize,
    /// Root mean square residuals of the balances with the fitted laws.
    pub balances_left_rms: BalanceResidual,
    /// Text on the parameters that the data can determine.
    pub identifiability: String,
}

/// Samples with a larger roll acceleration are excluded [rad/s2]: the paper's 100 degrees/s2.
const MAX_ROLL_ACCEL: f64 = 100.0 * std::f64::consts::PI / 180.0;

/// Samples of both runners (front, rear), with the forces of the base laws: measured forces minus
/// those of the vehicle's effects. Also the number of samples excluded for their roll acceleration.
///
/// `contacts` flags the samples to leave out, run by run; it may be empty. A cluster is a run if
/// there are at least twelve runs, else a stretch of four seconds of a run.
pub fn lateral_samples(
    runs: &[Prepared],
    vehicle: &Vehicle,
    contacts: &[Vec<bool>],
) -> ([Vec<LateralSample>; 2], usize) {
    let by_run = runs.len() >= 12;
    let of_run = |(number, run): (usize, &Prepared)| {
        let vehicle = &with_own_contacts(run, vehicle);
        let stretch = (4.0 / run.dt_s) as usize;
        let (mut samples, mut excluded) = ([Vec::new(), Vec::new()], 0);
        for (i, (state, motion)) in run.states.iter().zip(&run.motions).enumerate() {
            if state.roll_accel_radps2.abs() > MAX_ROLL_ACCEL {
                excluded += 1;
                continue;
            }
            if contacts.get(number).is_some_and(|marked| marked[i]) {
                continue;
            }
            let forces = inverse(vehicle, state, motion);
            let across = share_of_laws(vehicle, state, &forces);
            let of_stretch = number * 100_000 + i / stretch;
            let cluster = if by_run { number } else { of_stretch } as u32;
            let alpha = [state.alpha_f_rad, state.alpha_r_rad];
            for (axle, load) in [forces.front[2], forces.rear[2]].into_iter().enumerate() {
                samples[axle].push(LateralSample {
                    alpha: alpha[axle],
                    fz: load,
                    fy: across[axle],
                    cluster,
                });
            }
        }
        (samples, excluded)
    };
    let each: Vec<_> = runs.par_iter().enumerate().map(of_run).collect();
    let mut all = [Vec::new(), Vec::new()];
    let mut excluded = 0;
    for ([front, rear], left_out) in each {
        all[0].extend(front);
        all[1].extend(rear);
        excluded += left_out;
    }
    (all, excluded)
}
