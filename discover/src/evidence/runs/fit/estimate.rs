//! Parameter estimates with cluster-robust standard errors.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::evidence::runs::fit::gauss_newton::{FitProducts, Fitting, GaussNewtonStep, solve};
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::null::clusters::members;
use crate::regression::prior::Prior;

/// Estimate of a parameter, in the parameter's unit; base parameters as multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// The estimate with another standard error, and its interval in proportion.
    pub fn with_error(&self, error: f64) -> Self {
        let wider = error / self.error.max(1e-300);
        Self {
            error,
            low: self.value - wider * (self.value - self.low),
            high: self.value + wider * (self.high - self.value),
            ..*self
        }
    }

    /// The estimate if another value is stated instead of it; the difference of the two is added in
    /// quadrature to the standard error.
    pub fn stated_as(&self, value: f64) -> Self {
        let difference = value - self.value;
        self.moved(difference)
            .with_error(self.error.hypot(difference))
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
    /// For each session its runs and the change of these parameters if the session is omitted.
    pub left_out: Vec<(Vec<usize>, DVector<f64>)>,
}

impl FinalEstimates {
    /// The posterior given the base as stated: multipliers of 1.
    ///
    /// With x the estimates, V their covariance and subscript B the base parameters:
    ///
    /// ```text
    /// K = V_B inv(V_BB)      x' = x - K (x_B - 1)      V' = V - K V_B'
    /// ```
    ///
    /// A change d of the estimates becomes `d - K d_B`.
    pub fn given_base(mut self, free: &[usize]) -> Self {
        let (base, count) = (free.len(), self.covariance.nrows());
        let columns = self.covariance.columns(0, base).into_owned();
        let of_base = columns.rows(0, base).into_owned();
        let Some(inverse) = of_base.try_inverse() else {
            return self;
        };
        let gain = columns.clone() * inverse;
        let difference = DVector::from_fn(base, |k, _| self.estimates[k].value - 1.0);
        let shift = &gain * difference;
        self.covariance = &self.covariance - &gain * columns.transpose();
        for (_, change) in &mut self.left_out {
            *change -= &gain * change.rows(0, base);
        }
        for (k, estimate) in self.estimates.iter_mut().take(count).enumerate() {
            let error = self.covariance[(k, k)].max(0.0).sqrt();
            *estimate = estimate.moved(-shift[k]).with_error(error);
        }
        for b in free {
            self.model.base[*b] = 1.0;
        }
        let amplitudes = self.model.free().into_iter();
        for ((e, q), estimate) in amplitudes.zip(&self.estimates[base..count]) {
            let [low, high] = self.model.bounds(e, q);
            self.model.effects.active[e].values[q] = estimate.value.clamp(low, high);
        }
        self
    }
}

/// Smallest number of sessions that are used as clusters. Derived: standard errors with fewer than
/// four degrees of freedom are too uncertain.
const MIN_SESSIONS: usize = 5;

/// Estimates of all parameters of a fit.
///
/// With C the sum of the products of the columns and the precision P of the prior, the covariance
/// is the cluster-robust (sandwich) one over R sessions, or over R runs if there are fewer than
/// five sessions:
///
/// ```text
/// inv(C) ((R - 1)/R sum_i s_i s_i' + P) inv(C),   s_i = inv(1 - C_i inv(C)) u_i
/// ```
///
/// u_i is the score of cluster i, and s_i its score at the fit without it (the jackknife: R. M.
/// Bell and D. F. McCaffrey, Survey Methodology 28 (2002) 169). Intervals are those of Student's t
/// with R - 1 degrees of freedom.
pub fn estimate(fitting: &Fitting, model: &ResidualModel, whitener: &Whitener) -> FinalEstimates {
    let Fitting { frames, free, .. } = fitting;
    let FitProducts { by_run, prior } = fitting.products(model, whitener);
    let solved = solve(&by_run, &prior);
    let sessions = sessions(frames);
    // Clusters with independent errors: sessions, if there are enough of them.
    let by_session = sessions.len() >= MIN_SESSIONS;
    let score = |cluster: &[usize]| score_without(&by_run, cluster, &solved);
    let of_sessions: Vec<_> = sessions.iter().map(|runs| score(runs)).collect();
    let of_runs: Vec<_> = (0..frames.len()).map(|run| score(&[run])).collect();
    let of_clusters = if by_session { &of_sessions } else { &of_runs };
    let covariance = sandwich(of_clusters, &prior, &solved.inverse);
    let freedom = (of_clusters.len() as f64 - 1.0).max(1.0);
    let quantile = StudentsT::new(0.0, 1.0, freedom).map_or(2.0, |law| law.inverse_cdf(0.975));
    let amplitudes = model.free();
    let of_amplitudes = amplitudes.iter().map(|(e, q)| model.scale(*e, *q));
    let scales: Vec<f64> = free.iter().map(|_| 1.0).chain(of_amplitudes).collect();
    let active = &model.effects.active;
    let of_amplitudes = amplitudes.iter().map(|(e, q)| active[*e].values[*q]);
    let values = free.iter().map(|b| model.base[*b]).chain(of_amplitudes);
    let count = scales.len();
    let installation = if model.installation.fitted_count() == 0 {
        Vec::new()
    } else {
        let by_run = sandwich(&of_runs, &prior, &solved.inverse);
        let covariances = [&covariance, &by_run, &solved.inverse];
        installation_estimates(model, frames, count, covariances)
    };
    let covariance = DMatrix::from_fn(count, count, |i, k| {
        covariance[(i, k)] * scales[i] * scales[k]
    });
    let change = |score: &DVector<f64>| {
        let change = -(&solved.inverse * score);
        DVector::from_fn(count, |k, _| scales[k] * change[k])
    };
    let changes = of_sessions.iter().map(change);
    let left_out = if sessions.len() < 2 {
        Vec::new()
    } else {
        sessions.into_iter().zip(changes).collect()
    };
    let errors = (0..count).map(|k| covariance[(k, k)].max(0.0).sqrt());
    let estimates = values.zip(errors).chain(installation);
    let estimates = estimates.map(|(value, error)| Estimate {
        value,
        error,
        low: value - quantile * error,
        high: value + quantile * error,
    });
    FinalEstimates {
        estimates: estimates.collect(),
        model: model.clone(),
        covariance,
        left_out,
    }
}

/// Size and standard error of each installation error, in its unit; `first` is the index of the
/// first among the parameters.
///
/// `covariances`: by the clusters, by runs, and by the noise of the rows. The offset of one session
/// has no estimate without that session. Its error is that by the session's runs, at least that by
/// the noise, which alone remains of a session with one run.
fn installation_estimates(
    model: &ResidualModel,
    frames: &[Frame],
    first: usize,
    covariances: [&DMatrix<f64>; 3],
) -> Vec<(f64, f64)> {
    let installation = &model.installation;
    let count = installation.fitted_count();
    let [by_cluster, by_run, by_noise] = covariances.map(|covariance| {
        let own = covariance.view((first, first), (count, count));
        installation.estimates(&own.into_owned())
    });
    let estimate = |k: usize| {
        let (size, noise) = by_noise[k];
        let Some(session) = &installation.errors[k].session else {
            return by_cluster[k];
        };
        let runs = frames.iter().filter(|frame| frame.session == *session);
        let scatter = if runs.count() > 1 { by_run[k].1 } else { 0.0 };
        (size, noise.max(scatter))
    };
    (0..count).map(estimate).collect()
}

/// Score of a cluster of runs at the fit without it: `inv(1 - C_i inv(C)) u`, with u the score and
/// C_i the products of the cluster, and C the sum of all products and the prior.
fn score_without(
    grams: &[DMatrix<f64>],
    cluster: &[usize],
    GaussNewtonStep {
        by: step, inverse, ..
    }: &GaussNewtonStep,
) -> DVector<f64> {
    let p = step.len();
    let mut gram = DMatrix::zeros(p + 1, p + 1);
    cluster.iter().for_each(|i| gram += &grams[*i]);
    let products = gram.view((0, 0), (p, p));
    let score = gram.view((0, p), (p, 1)).column(0) - products * step;
    // If the fit without the cluster is singular, the score at the fit with it is used.
    let without = DMatrix::identity(p, p) - products * inverse;
    without.lu().solve(&score).unwrap_or(score)
}

/// Cluster-robust covariance of a step, including the prior's precision, from the score of each
/// cluster of runs at the fit without it.
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
    fn a_stated_base_gives_the_conditional_normal_law() {
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
        let given = found.given_base(&[0]);
        // Of a bivariate normal law: the mean moves by V_10/V_00, the variance falls to V_11 -
        // V_10^2/V_00.
        let slope = covariance[(1, 0)] / covariance[(0, 0)];
        let mean = [1.0, 0.4 - slope];
        let variance = [0.0, covariance[(1, 1)] - slope * covariance[(1, 0)]];
        let change = [0.0, 0.3 - slope * 0.2];
        for k in 0..2 {
            assert!((given.estimates[k].value - mean[k]).abs() < 1e-12);
            assert!((given.estimates[k].error.powi(2) - variance[k]).abs() < 1e-12);
            let half = 2.0 * given.estimates[k].error;
            assert!((given.estimates[k].high - mean[k] - half).abs() < 1e-12);
            assert!((given.left_out[0].1[k] - change[k]).abs() < 1e-12);
        }
        assert_eq!(given.model.base[0], given.estimates[0].value);
    }
}
