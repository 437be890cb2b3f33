//! Lateral friction of both runners from measured runs.

use std::borrow::Cow;
use std::collections::BTreeMap;

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
/// force from outside, such as a wall, are found ([`find_contacts`]) and excluded. Zero offsets of
/// slip angles in a session ([`SlipOffset`]), as of sensors that are mounted anew, are subtracted
/// from the runs, and the fit is repeated.
///
/// # Errors
/// [`Error::Undetermined`] where the data do not determine a runner's stiffness; [`Error::TooFew`]
/// without runs; [`Error::SlipOffsets`] if the fit fails with significant offsets subtracted.
pub fn fit(
    runs: &[Prepared],
    vehicle: &Vehicle,
    leave_out_contacts: bool,
) -> Result<FitResult, Error> {
    if runs.is_empty() {
        return Err(Error::too_few("runs to fit", 0, 1));
    }
    let mut laws = fit_laws(runs, vehicle, leave_out_contacts, None)?;
    let mut corrected = Cow::Borrowed(runs);
    let mut slip_offsets = Vec::new();
    for round in 0.. {
        let found = significant_offsets(&corrected, &laws.vehicle, &laws.contacts, &slip_offsets);
        let change = largest_change(&found, &slip_offsets);
        if change < MAX_OFFSET_CHANGE {
            break;
        }
        let failure = |reason| Error::SlipOffsets {
            offsets: slip_offsets_text(&found),
            reason: Box::new(reason),
        };
        if round == MAX_OFFSET_ROUNDS {
            return Err(failure(Error::NotConverged {
                what: "offsets and laws, change of an offset in standard errors",
                iterations: round,
                residual: change,
                tolerance: MAX_OFFSET_CHANGE,
            }));
        }
        corrected = Cow::Owned(without_slip_offsets(runs, &found));
        // Contacts are discrete: rounds that search for them need not converge.
        let contacts = (round >= CONTACT_ROUNDS).then_some(laws.contacts);
        laws = fit_laws(&corrected, vehicle, leave_out_contacts, contacts).map_err(failure)?;
        slip_offsets = found;
    }
    let contacts = laws.contacts.iter().flatten();
    Ok(FitResult {
        slip_offsets,
        front: laws.front,
        rear: laws.rear,
        confidence: CONFIDENCE,
        runs: runs.iter().map(|run| run.entry.run.clone()).collect(),
        samples: runs.iter().map(|run| run.states.len()).sum(),
        excluded_roll_acceleration: laws.excluded,
        excluded_contacts: contacts.filter(|marked| **marked).count(),
        balances_left_rms: balance_residuals(&corrected, &laws.vehicle),
        identifiability: IDENTIFIABILITY.to_owned(),
    })
}

/// Fitted laws of both runners.
struct FittedLaws {
    front: LateralFit,
    rear: LateralFit,
    /// The vehicle with these laws.
    vehicle: Vehicle,
    /// Samples excluded because of a force from outside, run by run; empty if none was searched for.
    contacts: Vec<Vec<bool>>,
    /// Number of samples excluded for their roll acceleration.
    excluded: usize,
}

/// Fits the laws of both runners as [`fit`], without offsets of slip angles. If `contacts` are
/// given, they are not searched for.
fn fit_laws(
    runs: &[Prepared],
    vehicle: &Vehicle,
    leave_out_contacts: bool,
    contacts: Option<Vec<Vec<bool>>>,
) -> Result<FittedLaws, Error> {
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
    let both = |contacts: Vec<Vec<bool>>, known: &Vehicle| {
        let ([front, rear], excluded) = lateral_samples(runs, known, &contacts);
        let (front, rear) = rayon::join(
            || fit_one(&front, &vehicle.front, 0),
            || fit_one(&rear, &vehicle.rear, 1),
        );
        let (front, rear) = (front?, rear?);
        Ok::<_, Error>(FittedLaws {
            vehicle: vehicle.with_lateral(front.law(), rear.law()),
            front,
            rear,
            contacts,
            excluded,
        })
    };
    let search = leave_out_contacts && contacts.is_none();
    let mut laws = both(contacts.unwrap_or_default(), vehicle)?;
    // The first fit is biased by the contacts, so that they are searched for again with the second
    // fit. Effects that scale with the stiffness of the laws use the stiffness of the previous
    // round.
    let has_effects = !vehicle.effects.is_empty();
    for _ in 0..if search || has_effects { 2 } else { 0 } {
        let contacts = if search {
            find_contacts(runs, &laws.vehicle)
        } else {
            std::mem::take(&mut laws.contacts)
        };
        if !has_effects && !contacts.iter().flatten().any(|marked| *marked) {
            break;
        }
        laws = both(contacts, &laws.vehicle)?;
    }
    Ok(laws)
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
    /// Zero offsets of slip angles by session that the fit subtracted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slip_offsets: Vec<SlipOffset>,
    /// Root mean square residuals of the balances with the fitted laws.
    pub balances_left_rms: BalanceResidual,
    /// Text on the parameters that the data can determine.
    pub identifiability: String,
}

/// Zero offset of the slip angle of a runner in the runs of a session: that of the slip sensor, and
/// for the front runner that of the steering sensor, too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SlipOffset {
    /// Session.
    pub session: String,
    /// Runner.
    pub runner: Axle,
    /// Recorded minus true slip angle [rad].
    pub offset_rad: f64,
    /// Standard error, from the scatter between stretches of four seconds [rad].
    pub error_rad: f64,
}

/// Front or rear runner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axle {
    /// Front runner.
    Front,
    /// Rear runner.
    Rear,
}

impl Axle {
    /// Both, as they are indexed.
    const BOTH: [Axle; 2] = [Axle::Front, Axle::Rear];

    /// The runner in words.
    pub fn name(self) -> &'static str {
        match self {
            Axle::Front => "front",
            Axle::Rear => "rear",
        }
    }
}

/// The offsets in words.
pub fn slip_offsets_text(offsets: &[SlipOffset]) -> String {
    let one = |one: &SlipOffset| {
        let (session, runner) = (&one.session, one.runner.name());
        let [offset, half_width] = [one.offset_rad, 1.96 * one.error_rad].map(|rad| 1e3 * rad);
        format!("session {session}, {runner}: {offset:.3} ± {half_width:.3} mrad")
    };
    offsets.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// Largest number of rounds of offsets and laws, each given the other.
const MAX_OFFSET_ROUNDS: usize = 8;
/// Number of rounds with a correction after which the contacts found are kept.
const CONTACT_ROUNDS: usize = 2;
/// Change of an offset in a round below which it has converged, in standard errors.
const MAX_OFFSET_CHANGE: f64 = 0.1;
/// Ratio of an offset to its standard error from which it is corrected.
const SIGNIFICANT_OFFSET: f64 = 3.0;
/// Smallest number of stretches from which an offset has a standard error.
const MIN_STRETCHES: usize = 5;

/// The offset of a runner's slip angle in a session [rad]; 0 if none is known.
fn offset_of(offsets: &[SlipOffset], session: &str, runner: Axle) -> f64 {
    let mut offsets = offsets.iter();
    let known = offsets.find(|one| one.session == session && one.runner == runner);
    known.map_or(0.0, |one| one.offset_rad)
}

/// The largest change of an offset in a round, in standard errors; 0 without offsets.
fn largest_change(found: &[SlipOffset], before: &[SlipOffset]) -> f64 {
    let change = |one: &SlipOffset| {
        let change = one.offset_rad - offset_of(before, &one.session, one.runner);
        change.abs() / one.error_rad
    };
    found.iter().map(change).fold(0.0, f64::max)
}

/// The significant zero offsets of slip angles by session, given the laws of `vehicle`, as the
/// first round of [`fit`] finds them. Stretches with a force from outside are excluded.
pub fn slip_offsets(runs: &[Prepared], vehicle: &Vehicle) -> Vec<SlipOffset> {
    significant_offsets(runs, vehicle, &find_contacts(runs, vehicle), &[])
}

/// The runs with the offsets of their slip angles subtracted: that of the rear runner from the slip
/// angle of the sled, and what the front's has in excess of it from the steering angle.
pub fn without_slip_offsets(runs: &[Prepared], offsets: &[SlipOffset]) -> Vec<Prepared> {
    let corrected = |run: &Prepared| {
        let mut run = run.clone();
        let [front, rear] = Axle::BOTH.map(|runner| offset_of(offsets, &run.entry.session, runner));
        for state in &mut run.states {
            state.alpha_cog_rad -= rear;
            state.alpha_r_rad -= rear;
            state.alpha_f_rad -= front;
            state.delta_rad -= front - rear;
        }
        run
    };
    runs.iter().map(corrected).collect()
}

/// The significant offsets given the laws of `vehicle`, by one Gauss-Newton step from the offsets
/// `before`, which were subtracted from the runs. These remain even if they are no longer significant:
/// otherwise one at the threshold would come and go.
///
/// ```text
/// r = F_y - F(alpha - o),   dr/do = F' = g,   o <- o - sum(r g) / sum(g^2)
/// var(o) = n / (n - 1) sum over stretches of (sum of r g after the step)^2 / (sum(g^2))^2
/// ```
///
/// A law vanishes at zero slip, so that an offset differs from any change of the law.
fn significant_offsets(
    runs: &[Prepared],
    vehicle: &Vehicle,
    contacts: &[Vec<bool>],
    before: &[SlipOffset],
) -> Vec<SlipOffset> {
    let laws = [&vehicle.front.lateral, &vehicle.rear.lateral];
    let of_run = |(number, run): (usize, &Prepared)| {
        let marked = contacts.get(number).map(Vec::as_slice);
        let (samples, _) = samples_of_run(run, vehicle, marked);
        [0, 1].map(|axle| {
            let mut sums: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
            for s in samples[axle].iter().filter(|s| s.fz > 0.0) {
                let law = laws[axle].derivatives(s.alpha, s.fz);
                let [score, information] = sums.entry(s.cluster).or_default();
                *score += (s.fy - law.fy) * law.alpha;
                *information += law.alpha * law.alpha;
            }
            sums.into_values().collect::<Vec<_>>()
        })
    };
    let by_run: Vec<[Vec<[f64; 2]>; 2]> = runs.par_iter().enumerate().map(of_run).collect();
    let mut sessions: BTreeMap<&str, [Vec<[f64; 2]>; 2]> = BTreeMap::new();
    for (run, sums) in runs.iter().zip(by_run) {
        let all = sessions.entry(&run.entry.session).or_default();
        for (all, sums) in all.iter_mut().zip(sums) {
            all.extend(sums);
        }
    }
    let offset = |session: &str, runner: Axle, stretches: &[[f64; 2]]| {
        let [score, information] = [0, 1].map(|k| stretches.iter().map(|s| s[k]).sum::<f64>());
        let step = -score / information;
        let remaining = stretches.iter().map(|s| (s[0] + step * s[1]).powi(2));
        let n = stretches.len() as f64;
        let variance = n / (n - 1.0) * remaining.sum::<f64>() / information.powi(2);
        let offset_before = offset_of(before, session, runner);
        let offset_rad = offset_before + step;
        let error_rad = variance.sqrt();
        let is_significant = offset_before != 0.0
            || stretches.len() >= MIN_STRETCHES
                && offset_rad.abs() > SIGNIFICANT_OFFSET * error_rad;
        is_significant.then(|| SlipOffset {
            session: session.to_owned(),
            runner,
            offset_rad,
            error_rad,
        })
    };
    let of_session = |(session, both): (&str, [Vec<[f64; 2]>; 2])| {
        Axle::BOTH.map(|runner| offset(session, runner, &both[runner as usize]))
    };
    sessions
        .into_iter()
        .flat_map(of_session)
        .flatten()
        .collect()
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
        let marked = contacts.get(number).map(Vec::as_slice);
        let (mut samples, excluded) = samples_of_run(run, vehicle, marked);
        let number = number as u32;
        for sample in samples.iter_mut().flatten() {
            sample.cluster = if by_run {
                number
            } else {
                number * 100_000 + sample.cluster
            };
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

/// Samples of both runners in one run, as [`lateral_samples`]; a cluster is a stretch of four
/// seconds.
fn samples_of_run(
    run: &Prepared,
    vehicle: &Vehicle,
    marked: Option<&[bool]>,
) -> ([Vec<LateralSample>; 2], usize) {
    let vehicle = &with_own_contacts(run, vehicle);
    let stretch = (4.0 / run.dt_s) as usize;
    let (mut samples, mut excluded) = ([Vec::new(), Vec::new()], 0);
    for (i, (state, motion)) in run.states.iter().zip(&run.motions).enumerate() {
        if state.roll_accel_radps2.abs() > MAX_ROLL_ACCEL {
            excluded += 1;
            continue;
        }
        if marked.is_some_and(|marked| marked[i]) {
            continue;
        }
        let forces = inverse(vehicle, state, motion);
        let across = share_of_laws(vehicle, state, &forces);
        let alpha = [state.alpha_f_rad, state.alpha_r_rad];
        for (axle, load) in [forces.front[2], forces.rear[2]].into_iter().enumerate() {
            samples[axle].push(LateralSample {
                alpha: alpha[axle],
                fz: load,
                fy: across[axle],
                cluster: (i / stretch) as u32,
            });
        }
    }
    (samples, excluded)
}
