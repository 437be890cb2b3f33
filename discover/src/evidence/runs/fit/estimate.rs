//! Fitted parameters with intervals: bias of noisy inputs taken off, errors from the scatter of whole sessions or runs.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::runs::fit::gauss_newton::stepped;
use crate::evidence::runs::fit::noise_products::mean_noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::clusters::members;
use crate::regression::prior::Prior;

/// A parameter in its own unit (base parameters: as multipliers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// The same with another standard error.
    pub fn with_error(&self, error: f64) -> Self {
        let wider = error / self.error.max(1e-300);
        Self {
            error,
            low: self.value - wider * (self.value - self.low),
            high: self.value + wider * (self.high - self.value),
            ..*self
        }
    }

    /// What is known where another value is stated in its place: that this is off as well.
    pub fn stated_as(&self, value: f64) -> Self {
        let off = value - self.value;
        let moved = Self {
            value,
            low: self.low + off,
            high: self.high + off,
            ..*self
        };
        moved.with_error(self.error.hypot(off))
    }
}

/// What is estimated from: a fitted model and the runs that it is fitted to.
pub struct FittedRows<'a> {
    /// The model.
    pub residual_model: &'a ResidualModel,
    /// Its rows' whitening.
    pub whitener: &'a Whitener,
    /// The runs.
    pub frames: &'a [Frame],
    /// Base parameters that are fitted.
    pub free: &'a [usize],
    /// Simulates runs with the model.
    pub simulator: &'a RunSimulator,
}

/// The first round of twins.
pub const FIRST_ROUND: u64 = 4_000_037;

/// Estimates of all fitted parameters (base, amplitudes, installation), and the model that holds them.
///
/// Newton steps on the corrected scores lead from least squares to the unbiased estimate. With C the corrected products,
/// errors are the sandwich over sessions (over runs where there are fewer than five), `(R - 1)/R inv(C_JJ) sum_i s_i s_i' inv(C_JJ)`,
/// `s_i = inv(1 - C_i,JJ inv(C_JJ)) u_i` the corrected score of session i as the fit without it leaves it (the jackknife: R. M. Bell and
/// D. F. McCaffrey, Survey Methodology 28 (2002) 169), with Student's t of R - 1; `trust` of the way from least squares is added to them. With `settle` false the
/// values stay at least squares. `pairs` says how many pairs of twins are behind each step: a single one leaves a tenth of what
/// it takes off in doubt.
pub fn estimate(
    rows: &FittedRows,
    pairs: &[u64],
    trust: f64,
    settle: bool,
) -> (Vec<Estimate>, ResidualModel) {
    let FittedRows {
        residual_model,
        whitener,
        frames,
        free,
        simulator,
    } = *rows;
    let mut settled = residual_model.clone();
    let (clusters, rounds) = (clusters(frames), pairs.len());
    let mut errors = Vec::new();
    let mut drawn = FIRST_ROUND;
    for (round, pairs) in pairs.iter().copied().enumerate() {
        let design = Design {
            residual_model: &settled,
            whitener,
            free_base: free,
            candidates: &[],
            local: &[],
            windows: &[],
        };
        let p = design.fitted();
        let products = design.products(frames);
        let noise = mean_noise_products(&design, frames, simulator, drawn..drawn + pairs);
        drawn += pairs;
        let runs: Vec<DMatrix<f64>> = products
            .iter()
            .zip(&noise)
            .map(|(x, d)| {
                let c = &x.full - d;
                c.view((OWN_LEVELS, OWN_LEVELS), (p + 1, p + 1))
                    .into_owned()
            })
            .collect();
        let prior = design.prior();
        let solved = solve(&runs, &prior);
        if round + 1 == rounds {
            errors = standard_errors(&runs, &clusters, &prior, &solved);
        }
        settled = stepped(&settled, free, solved.0.as_slice(), 1.0);
    }
    let scales: Vec<f64> = vec![1.0; free.len()]
        .into_iter()
        .chain(
            residual_model
                .free()
                .iter()
                .map(|(e, q)| residual_model.scale(*e, *q)),
        )
        .collect();
    let values = |residual_model: &ResidualModel, like: &ResidualModel| -> Vec<f64> {
        let amplitudes = like.free();
        free.iter()
            .map(|b| residual_model.base[*b])
            .chain(
                amplitudes
                    .iter()
                    .map(|(e, q)| residual_model.effects.active[*e].values[*q]),
            )
            .collect()
    };
    let (fitted, moved) = (
        values(residual_model, residual_model),
        values(&settled, residual_model),
    );
    let n = clusters.len() as f64;
    let quantile =
        StudentsT::new(0.0, 1.0, (n - 1.0).max(1.0)).map_or(2.0, |law| law.inverse_cdf(0.975));
    let known = &errors[fitted.len()..][..settled.installation.fitted()];
    let parts = settled.installation.found(known).into_iter();
    let parts = parts.map(|(value, error)| Estimate {
        value,
        error,
        low: value - quantile * error,
        high: value + quantile * error,
    });
    let estimates = (0..fitted.len())
        .map(|k| {
            let value = if settle { moved[k] } else { fitted[k] };
            let error = (errors[k] * scales[k]).hypot(trust * (moved[k] - fitted[k]));
            Estimate {
                value,
                error,
                low: value - quantile * error,
                high: value + quantile * error,
            }
        })
        .chain(parts)
        .collect();
    (
        estimates,
        if settle {
            settled
        } else {
            residual_model.clone()
        },
    )
}

/// One step, and the inverse of the products with the prior's precision.
pub fn solve(grams: &[DMatrix<f64>], prior: &Prior) -> (DVector<f64>, DMatrix<f64>) {
    let p = prior.count();
    let mut total = DMatrix::zeros(p + 1, p + 1);
    for gram in grams {
        total += gram;
    }
    let inverse = prior.inverse(total.view((0, 0), (p, p)).into_owned());
    let step = &inverse * (total.view((0, p), (p, 1)).column(0) + prior.scores(&prior.at));
    (step, inverse)
}

/// Sandwich errors of a step over clusters of runs, with what the prior leaves open.
fn standard_errors(
    grams: &[DMatrix<f64>],
    clusters: &[Vec<usize>],
    prior: &Prior,
    (step, inverse): &(DVector<f64>, DMatrix<f64>),
) -> Vec<f64> {
    let p = prior.count();
    let mut meat = DMatrix::zeros(p, p);
    for cluster in clusters {
        let mut gram = DMatrix::zeros(p + 1, p + 1);
        cluster.iter().for_each(|i| gram += &grams[*i]);
        let own = gram.view((0, 0), (p, p));
        let score = gram.view((0, p), (p, 1)) - own * step;
        // A cluster without which nothing could be fitted has no score of its own.
        let without = DMatrix::identity(p, p) - own * inverse;
        let score = without.lu().solve(&score).unwrap_or(score);
        meat += &score * score.transpose();
    }
    let n = clusters.len() as f64;
    let random = DMatrix::from_diagonal(&prior.precision);
    let covariance = inverse * (meat * ((n - 1.0) / n) + random) * inverse;
    (0..p).map(|k| covariance[(k, k)].max(0.0).sqrt()).collect()
}

/// Runs whose errors are independent of other runs': those of a session, where there are enough of them.
fn clusters(frames: &[Frame]) -> Vec<Vec<usize>> {
    /// Fewest sessions. Derived: with fewer than four degrees of freedom errors from their scatter say next to nothing.
    const FEWEST: usize = 5;
    let sessions = members(frames.iter().map(|frame| frame.session.as_str()));
    match sessions.len() >= FEWEST {
        true => sessions.into_values().collect(),
        false => (0..frames.len()).map(|i| vec![i]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_stated_for_another_is_as_unsure_as_that_and_the_way_between_them() {
        let known = Estimate {
            value: 1.0,
            error: 0.03,
            low: 0.94,
            high: 1.06,
        };
        let stated = known.stated_as(1.04);
        assert!((stated.value - 1.04).abs() < 1e-15);
        assert!((stated.error - 0.05).abs() < 1e-12);
        // Two standard errors to either side, as before.
        assert!((stated.low - 0.94).abs() < 1e-12 && (stated.high - 1.14).abs() < 1e-12);
    }
}
