//! Samples of slip, load and lateral force from measured runs.

use crate::friction::LateralSample;
use rayon::prelude::*;

use crate::fit::own_contacts::with_own_contacts;
use crate::model::vehicle::Vehicle;
use crate::motion::one_track::{inverse, share_of_laws};
use crate::signals::prepare::Prepared;

/// How samples are chosen and fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Samples with a larger roll acceleration are left out [rad/s2]; the paper's 100 degrees/s2.
    pub most_roll_accel_radps2: f64,
    /// Predefined curvature factor E of both runners.
    pub e: f64,
    /// Whether stretches with a force from outside, such as a wall, are found and left out ([`crate::find_contacts`]).
    pub leave_out_contacts: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions {
            most_roll_accel_radps2: 100.0_f64.to_radians(),
            e: 0.99,
            leave_out_contacts: true,
        }
    }
}

/// Samples of both runners (front, rear): what is left to the base laws once the vehicle's effects have given their share,
/// and how many were left out for their roll acceleration.
///
/// `contacts` marks samples to leave out, a run; empty for none. A cluster is a run where there are at least twelve, else a stretch of four seconds of one.
pub fn lateral_samples(
    runs: &[Prepared],
    vehicle: &Vehicle,
    contacts: &[Vec<bool>],
    options: &FitOptions,
) -> ([Vec<LateralSample>; 2], usize) {
    let by_run = runs.len() >= 12;
    let each: Vec<([Vec<LateralSample>; 2], usize)> = runs
        .par_iter()
        .enumerate()
        .map(|(number, run)| {
            let vehicle = &with_own_contacts(run, vehicle);
            let stretch = (4.0 / run.dt_s) as usize;
            let (mut front, mut rear, mut excluded) = (Vec::new(), Vec::new(), 0);
            for (i, (state, motion)) in run.states.iter().zip(&run.motions).enumerate() {
                if state.roll_accel_radps2.abs() > options.most_roll_accel_radps2 {
                    excluded += 1;
                    continue;
                }
                if contacts.get(number).is_some_and(|marked| marked[i]) {
                    continue;
                }
                let forces = inverse(vehicle, state, motion);
                let across = share_of_laws(vehicle, state, &forces);
                let cluster = if by_run {
                    number
                } else {
                    number * 100_000 + i / stretch
                } as u32;
                let sample = |alpha, force: &[f64; 3], fy| LateralSample {
                    alpha,
                    fz: force[2],
                    fy,
                    cluster,
                };
                front.push(sample(state.alpha_f_rad, &forces.front, across[0]));
                rear.push(sample(state.alpha_r_rad, &forces.rear, across[1]));
            }
            ([front, rear], excluded)
        })
        .collect();
    let mut all = [Vec::new(), Vec::new()];
    let mut excluded = 0;
    for ([front, rear], left_out) in each {
        all[0].extend(front);
        all[1].extend(rear);
        excluded += left_out;
    }
    (all, excluded)
}
