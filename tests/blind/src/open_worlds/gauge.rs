//! Sizes of what is hidden, and the refitted base that written models are compared with.
//!
//! Both need residuals. They come from the inversion of [`crate::inverse`], which has no code in
//! common with the ride.

use super::campaign::{Campaign, Run};
use super::hidden::{Hidden, Secret};
use super::recorder::Row;
use super::ride::RATE_HZ;
use crate::residuals::inverse::{low_pass, residuals_every};
use crate::residuals::least_squares::{dot, project_out};
use crate::residuals::sizing::{Wanted, sized};
use crate::world::sensors::Sample;

/// Low-pass of along, speed, side and yaw residual [Hz].
const CUTOFF_HZ: [f64; 4] = [20.0, 5.0, 20.0, 20.0];
/// Rows at both ends of a run that take no part: the filter's, and those of the brake.
const ENDS: [usize; 2] = [20, 300];
/// Every so many rows are compared.
const STRIDE: usize = 4;
/// Weights of the residuals in a refit of the base: over what noise leaves in them, and none for
/// the speed, which the base changes as it does the residual along.
const WEIGHTS: [f64; 4] = [1.0 / 0.05, 0.0, 1.0 / 0.06, 1.0 / 0.08];
/// Relative steps of the base parameters.
const STEP: f64 = 0.02;

/// `mu`, front stiffness and `mu_zeta`, rear stiffness and `mu_zeta`, over those stated.
type Base = [f64; 5];

/// Residuals of some runs: along [m/s2], speed [m/s2], side [m/s2], yaw [rad/s2].
fn residuals(campaign: &Campaign, runs: &[&Run], rows: &[Vec<Row>], base: &Base) -> [Vec<f64>; 4] {
    let (mu, lateral) = campaign.stated();
    let lateral = std::array::from_fn(|axle: usize| {
        [0, 1].map(|k| lateral[axle][k] * base[1 + 2 * axle + k])
    });
    let sled = campaign
        .faults
        .weighed(&campaign.sled)
        .inverted(mu * base[0], lateral);
    let mut all: [Vec<f64>; 4] = Default::default();
    for (run, rows) in runs.iter().zip(rows) {
        let samples: Vec<Sample> = rows.iter().map(sample).collect();
        let slope = |s: f64| -campaign.surveyed(run, s);
        let rest = residuals_every(1, &sled, &campaign.conditions(run), &samples, &slope);
        let pick = [
            rest.iter().map(|r| r.x_mps2).collect::<Vec<f64>>(),
            rest.iter().map(|r| r.v_mps2).collect(),
            rest.iter().map(|r| r.y_mps2).collect(),
            rest.iter().map(|r| r.yaw_radps2).collect(),
        ];
        for ((all, mut values), cutoff) in all.iter_mut().zip(pick).zip(CUTOFF_HZ) {
            low_pass(&mut values, cutoff);
            let inside = ENDS[0]..values.len().saturating_sub(ENDS[1]).max(ENDS[0]);
            all.extend(values[inside].iter().step_by(STRIDE));
        }
    }
    all
}

fn sample(row: &Row) -> Sample {
    let [
        ax,
        ay,
        az,
        p,
        q,
        r,
        v_mps,
        alpha_rad,
        delta_rad,
        gamma_rad,
        extra,
    ] = *row;
    Sample {
        accel_mps2: [ax, ay, az],
        rates_radps: [p, q, r],
        v_mps,
        alpha_rad,
        delta_rad,
        gamma_rad,
        extra,
        ..Sample::default()
    }
}

/// Root mean square over the rows.
fn rms(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// How each base parameter changes the residuals.
fn columns(campaign: &Campaign, runs: &[&Run], rows: &[Vec<Row>], at: &Base) -> [[Vec<f64>; 4]; 5] {
    let here = residuals(campaign, runs, rows, at);
    std::array::from_fn(|k| {
        let mut moved = *at;
        moved[k] *= 1.0 + STEP;
        let there = residuals(campaign, runs, rows, &moved);
        std::array::from_fn(|c| {
            let change = difference(&there[c], &here[c]);
            change.iter().map(|x| x / (STEP * at[k])).collect()
        })
    })
}

/// A few undisturbed runs of the quiet campaign, for sizes.
pub struct Gauge<'a> {
    campaign: &'a Campaign,
    runs: Vec<&'a Run>,
    still: [Vec<f64>; 4],
    noise: [f64; 4],
    base: [[Vec<f64>; 4]; 5],
    rows: Vec<usize>,
}

/// Steps a second of the rides that sizes are sought with.
const SIZING_HZ: f64 = RATE_HZ / 2.0;

impl<'a> Gauge<'a> {
    /// Drives one run of each of the first four sessions.
    pub fn new(campaign: &'a Campaign) -> Self {
        let of = |session: usize| campaign.runs.iter().find(|run| run.session == session);
        let runs: Vec<&Run> = (0..4).filter_map(of).collect();
        let drive = |noisy| -> Vec<Vec<Row>> {
            let record = |run: &&Run| campaign.record(run, &Secret::default(), SIZING_HZ, noisy);
            runs.iter().map(record).collect()
        };
        let (rows, noisy) = (drive(false), drive(true));
        let still = residuals(campaign, &runs, &rows, &[1.0; 5]);
        let loud = residuals(campaign, &runs, &noisy, &[1.0; 5]);
        Self {
            noise: std::array::from_fn(|c| rms(&difference(&loud[c], &still[c]))),
            base: columns(campaign, &runs, &rows, &[1.0; 5]),
            rows: rows.iter().map(Vec::len).collect(),
            campaign,
            runs,
            still,
        }
    }

    /// Standard deviations that noise leaves in the residuals: along, speed, side [m/s2], yaw
    /// [rad/s2].
    pub fn noise_sd(&self) -> [f64; 4] {
        self.noise
    }

    /// Standard deviations that the undisturbed runs leave after a refit of the base, without
    /// noise.
    pub fn structure_sd(&self) -> [f64; 4] {
        std::array::from_fn(|c| {
            let columns: Vec<Vec<f64>> = self.base.iter().map(|column| column[c].clone()).collect();
            rms(&project_out(&columns, &self.still[c]))
        })
    }

    /// Variance that something hidden adds to the residuals after a refit of the base, over that of
    /// the noise: along and speed, or side and yaw, whichever is more. Not a number where the sled
    /// does not arrive.
    pub fn share(&self, hidden: &Hidden) -> f64 {
        let secret = Secret(vec![*hidden]);
        let mut rows = Vec::new();
        for (run, count) in self.runs.iter().zip(&self.rows) {
            let mut of = self.campaign.record(run, &secret, SIZING_HZ, false);
            if of.len() + ENDS[1] < *count {
                return f64::NAN;
            }
            // Runs end earlier or later than without, in rows that take no part.
            of.resize(*count, of[of.len() - 1]);
            rows.push(of);
        }
        let with = residuals(self.campaign, &self.runs, &rows, &[1.0; 5]);
        let group = |channels: [usize; 2]| {
            let scaled = |of: &[Vec<f64>; 4]| -> Vec<f64> {
                let part = |c: usize| of[c].iter().map(move |x| x / self.noise[c]);
                channels.into_iter().flat_map(part).collect()
            };
            let base: Vec<Vec<f64>> = self.base.iter().map(scaled).collect();
            let change = std::array::from_fn(|c| difference(&with[c], &self.still[c]));
            rms(&project_out(&base, &scaled(&change))).powi(2)
        };
        group([0, 1]).max(group([2, 3]))
    }

    /// Sets the size that has this share of the noise's variance, or the largest; gives the share.
    pub fn size(&self, hidden: &mut Hidden, share: f64) -> f64 {
        let sign = hidden.size.signum();
        let effect = hidden.effect;
        let wanted = Wanted {
            share,
            within: 0.1,
            bounds: [1e-3 * effect.start, effect.most],
        };
        let (size, reached) = sized(effect.start, 2.0, wanted, |size| {
            self.share(&Hidden {
                size: sign * size,
                ..*hidden
            })
        });
        hidden.size = sign * size;
        reached
    }
}

/// The base fitted to recorded runs by least squares, installation errors ignored: `mu`, stiffness
/// [N/rad] and `mu_zeta` of the axles.
///
/// Three steps of Gauss and Newton, with the derivatives at the stated base, on the residuals along, at the side and of the yaw; the normal equations by Gauss and Seidel.
pub fn refitted(campaign: &Campaign, runs: &[&Run], rows: &[Vec<Row>]) -> (f64, [[f64; 2]; 2]) {
    let mut base: Base = [1.0; 5];
    let change = columns(campaign, runs, rows, &base);
    for _ in 0..3 {
        let rest = residuals(campaign, runs, rows, &base);
        let inner = |a: &[Vec<f64>; 4], b: &[Vec<f64>; 4]| -> f64 {
            (0..4).map(|c| WEIGHTS[c].powi(2) * dot(&a[c], &b[c])).sum()
        };
        let gram = change
            .each_ref()
            .map(|a| change.each_ref().map(|b| inner(a, b)));
        let right = change.each_ref().map(|a| -inner(a, &rest));
        let mut step = [0.0; 5];
        for _ in 0..500 {
            for j in 0..5 {
                let others: f64 = (0..5)
                    .filter(|k| *k != j)
                    .map(|k| gram[j][k] * step[k])
                    .sum();
                step[j] = (right[j] - others) / gram[j][j];
            }
        }
        // Stays positive, however bad the data are.
        for (value, step) in base.iter_mut().zip(step) {
            *value = (*value + step).clamp(0.1 * *value, 10.0 * *value);
        }
    }
    let (mu, lateral) = campaign.stated();
    let lateral = std::array::from_fn(|axle: usize| {
        [0, 1].map(|k| lateral[axle][k] * base[1 + 2 * axle + k])
    });
    (mu * base[0], lateral)
}
