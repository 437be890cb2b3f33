//! Parameter estimates corrected for the bias of noisy inputs, with cluster-robust standard errors.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::runs::fit::gauss_newton::stepped;
use crate::evidence::runs::fit::noise_products::{corrected, fitted_products, mean_noise_products};
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::Design;
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

    /// The uncertainty if another value is stated instead: its difference is added.
    pub fn stated_as(&self, value: f64) -> Self {
        let off = value - self.value;
        self.moved(off).with_error(self.error.hypot(off))
    }

    fn moved(&self, by: f64) -> Self {
        Self {
            value: self.value + by,
            low: self.low + by,
            high: self.high + by,
            ..*self
        }
    }
}

/// Estimates of all fitted parameters and the model with these values.
#[derive(Clone)]
pub struct FinalEstimates {
    /// Base parameters (as multipliers), amplitudes, then installation errors.
    pub estimates: Vec<Estimate>,
    pub model: ResidualModel,
    /// Covariance of base parameters and amplitudes, in their own units.
    pub covariance: DMatrix<f64>,
    /// For each session its runs and the change of these parameters if it is left out.
    pub left_out: Vec<(Vec<usize>, DVector<f64>)>,
}

impl FinalEstimates {
    /// The posterior given a normal prior of mean 1 and standard deviation `sd` of the base
    /// parameters.
    ///
    /// With x the estimates, V their covariance and B the base's columns:
    ///
    /// ```text
    /// K = V_B inv(V_BB + sd^2)      x' = x - K (x_B - 1)      V' = V - K V_B'
    /// ```
    ///
    /// A change d of the estimates becomes `d - K d_B`.
    pub fn given_base(self, free: &[usize], sd: f64) -> Self {
        let Self {
            mut estimates,
            mut model,
            covariance,
            mut left_out,
        } = self;
        let (known, count) = (free.len(), covariance.nrows());
        let columns = covariance.columns(0, known).into_owned();
        let own = columns.rows(0, known) + DMatrix::identity(known, known) * (sd * sd);
        let Some(inverse) = own.try_inverse() else {
            return Self {
                estimates,
                model,
                covariance,
                left_out,
            };
        };
        let gain = columns.clone() * inverse;
        let off = DVector::from_fn(known, |k, _| estimates[k].value - 1.0);
        let shift = &gain * off;
        let covariance = &covariance - &gain * columns.transpose();
        for (_, change) in &mut left_out {
            *change -= &gain * change.rows(0, known);
        }
        for (k, estimate) in estimates.iter_mut().take(count).enumerate() {
            let error = covariance[(k, k)].max(0.0).sqrt();
            *estimate = estimate.moved(-shift[k]).with_error(error);
        }
        for (b, estimate) in free.iter().zip(&estimates) {
            model.base[*b] = estimate.value;
        }
        let amplitudes = model.free();
        for ((e, q), estimate) in amplitudes.into_iter().zip(&estimates[known..count]) {
            let [low, high] = model.bounds(e, q);
            model.effects.active[e].values[q] = estimate.value.clamp(low, high);
        }
        Self {
            estimates,
            model,
            covariance,
            left_out,
        }
    }
}

/// A fitted model and its training runs.
pub struct FittedRows<'a> {
    pub residual_model: &'a ResidualModel,
    pub whitener: &'a Whitener,
    pub frames: &'a [Frame],
    pub free: &'a [usize],
    pub simulator: &'a RunSimulator,
}

/// First index of the simulated runs' random streams.
pub const FIRST_ROUND: u64 = 4_000_037;

/// Fewest sessions that serve as clusters. Derived: errors with fewer than four degrees of freedom
/// are too uncertain.
const FEWEST: usize = 5;

/// Estimates of all fitted parameters.
///
/// Newton steps on the corrected scores lead from least squares to the unbiased estimate. With C
/// the corrected products, the covariance is the sandwich over sessions (over runs if there are
/// fewer than five), `(R - 1)/R inv(C_JJ) sum_i s_i s_i' inv(C_JJ)`, where `s_i = inv(1 - C_i,JJ
/// inv(C_JJ)) u_i` is the corrected score of session i at the fit without it (the jackknife: R. M.
/// Bell and D. F. McCaffrey, Survey Methodology 28 (2002) 169). Intervals have Student's t of R -
/// 1; `trust` of the distance from least squares is added to the errors. Without `settle` the
/// values remain those of least squares. `pairs` are the pairs of simulated runs of each step; a
/// single one has a Monte Carlo error of a tenth of the correction.
pub fn estimate(rows: &FittedRows, pairs: &[u64], trust: f64, settle: bool) -> FinalEstimates {
    let FittedRows {
        residual_model,
        whitener,
        frames,
        free,
        simulator,
    } = *rows;
    let mut settled = residual_model.clone();
    let (sessions, rounds) = (sessions(frames), pairs.len());
    // Clusters with independent errors: sessions, if there are enough of them.
    let by_session = sessions.len() >= FEWEST;
    let mut covariance = DMatrix::zeros(0, 0);
    let mut left_out = Vec::new();
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
        let products = design.products(frames);
        let noise = mean_noise_products(&design, frames, simulator, drawn..drawn + pairs);
        drawn += pairs;
        let prior = design.prior();
        let runs = corrected(&fitted_products(&design, &products, &noise), &prior);
        let solved = solve(&runs, &prior);
        if round + 1 == rounds {
            let score = |cluster: &[usize]| score_without(&runs, cluster, &solved);
            let of_sessions: Vec<_> = sessions.iter().map(|runs| score(runs)).collect();
            covariance = match by_session {
                true => sandwich(&of_sessions, &prior, &solved.1),
                false => {
                    let of_runs: Vec<_> = (0..frames.len()).map(|run| score(&[run])).collect();
                    sandwich(&of_runs, &prior, &solved.1)
                }
            };
            if sessions.len() > 1 {
                let changes = of_sessions.iter().map(|score| -(&solved.1 * score));
                left_out = sessions.iter().cloned().zip(changes).collect();
            }
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
    let n = if by_session {
        sessions.len()
    } else {
        frames.len()
    } as f64;
    let quantile =
        StudentsT::new(0.0, 1.0, (n - 1.0).max(1.0)).map_or(2.0, |law| law.inverse_cdf(0.975));
    let errors = covariance.diagonal().map(|x| x.max(0.0).sqrt());
    let known = errors.rows(fitted.len(), settled.installation.fitted());
    let parts = settled.installation.found(known.as_slice()).into_iter();
    let covariance = DMatrix::from_fn(fitted.len(), fitted.len(), |i, k| {
        let doubt = match i == k {
            true => trust * (moved[k] - fitted[k]),
            false => 0.0,
        };
        covariance[(i, k)] * scales[i] * scales[k] + doubt * doubt
    });
    for (_, change) in &mut left_out {
        *change = DVector::from_fn(scales.len(), |k, _| scales[k] * change[k]);
    }
    let values = if settle { moved } else { fitted };
    let known = values.into_iter().enumerate();
    let known = known.map(|(k, value)| (value, covariance[(k, k)].max(0.0).sqrt()));
    let estimates = known.chain(parts).map(|(value, error)| Estimate {
        value,
        error,
        low: value - quantile * error,
        high: value + quantile * error,
    });
    let estimates = estimates.collect();
    let model = match settle {
        true => settled,
        false => residual_model.clone(),
    };
    FinalEstimates {
        estimates,
        model,
        covariance,
        left_out,
    }
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

/// Score of a cluster of runs at the fit without it. With u its score and C its products,
/// `inv(1 - C inv(C_JJ)) u`.
fn score_without(
    grams: &[DMatrix<f64>],
    cluster: &[usize],
    (step, inverse): &(DVector<f64>, DMatrix<f64>),
) -> DVector<f64> {
    let p = step.len();
    let mut gram = DMatrix::zeros(p + 1, p + 1);
    cluster.iter().for_each(|i| gram += &grams[*i]);
    let own = gram.view((0, 0), (p, p));
    let score = gram.view((0, p), (p, 1)).column(0) - own * step;
    // A cluster without which the fit is singular has no score of its own.
    let without = DMatrix::identity(p, p) - own * inverse;
    without.lu().solve(&score).unwrap_or(score)
}

/// Sandwich covariance of a step, with the prior's remaining covariance, from the score of each
/// cluster of runs.
fn sandwich(scores: &[DVector<f64>], prior: &Prior, inverse: &DMatrix<f64>) -> DMatrix<f64> {
    let p = prior.count();
    let mut meat = DMatrix::zeros(p, p);
    for score in scores {
        meat += score * score.transpose();
    }
    let n = scores.len() as f64;
    let random = DMatrix::from_diagonal(&prior.precision);
    inverse * (meat * ((n - 1.0) / n) + random) * inverse
}

/// The runs of each session.
fn sessions(frames: &[Frame]) -> Vec<Vec<usize>> {
    let sessions = members(frames.iter().map(|frame| frame.session.as_str()));
    sessions.into_values().collect()
}

#[cfg(test)]
mod tests {
    use kufe_sled::effects::Effects;
    use kufe_sled::{Model, Vehicle};

    use super::*;
    use crate::evidence::runs::model::residual_model::BASE;

    #[test]
    fn a_stated_value_has_the_error_of_the_estimate_and_the_difference() {
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

    #[test]
    fn a_prior_of_the_base_gives_the_normal_posterior() {
        let vehicle = Vehicle::new(&Model::published()).unwrap();
        let covariance = DMatrix::from_row_slice(2, 2, &[0.25, -0.1, -0.1, 0.09]);
        let estimate = |value: f64, error: f64| Estimate {
            value,
            error,
            low: value - 2.0 * error,
            high: value + 2.0 * error,
        };
        let found = FinalEstimates {
            estimates: vec![estimate(2.0, 0.5), estimate(0.4, 0.3)],
            model: ResidualModel::new(vehicle, [1.0; BASE], Effects::default()),
            covariance: covariance.clone(),
            left_out: vec![(vec![0], DVector::from_column_slice(&[0.2, 0.3]))],
        };
        let sd = 0.5;
        let given = found.given_base(&[0], sd);
        // Precisions add: that of the data, and 1 / sd^2 about 1 of the first alone.
        let precision = covariance.try_inverse().unwrap();
        let prior = DMatrix::from_diagonal(&DVector::from_column_slice(&[1.0 / (sd * sd), 0.0]));
        let posterior = (&precision + &prior).try_inverse().unwrap();
        let at = DVector::from_column_slice(&[2.0, 0.4]);
        let mean = &posterior * (&precision * at + &prior * DVector::from_element(2, 1.0));
        let moved = DVector::from_column_slice(&[2.2, 0.7]);
        let moved = &posterior * (&precision * moved + prior * DVector::from_element(2, 1.0));
        assert!((&given.left_out[0].1 - (moved - &mean)).amax() < 1e-12);
        for k in 0..2 {
            assert!((given.estimates[k].value - mean[k]).abs() < 1e-12);
            assert!((given.estimates[k].error - posterior[(k, k)].sqrt()).abs() < 1e-12);
            let half = 2.0 * given.estimates[k].error;
            assert!((given.estimates[k].high - mean[k] - half).abs() < 1e-12);
        }
        assert_eq!(given.model.base[0], given.estimates[0].value);
    }
}
