//! Closed share of the explainable misfit on held-out runs.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{Interval, undetermined_share};
use crate::null::random::{below, stream};
use crate::procedure::rules::RunRules;
use crate::regression::prior::Prior;
use crate::regression::scores::studentised;

impl Campaign<'_> {
    /// Share of the explainable misfit that is closed.
    ///
    /// f is the part of the initial residual that the candidates' columns explain, with
    /// coefficients fitted to the training runs ([`explained`]). On the held-out runs, whose noise
    /// is independent of f, `f . r_before` measures the explainable part and `f . r_after` the part
    /// of it that remains. The bias of noisy inputs in both is determined from simulated runs and
    /// subtracted. The interval is a bootstrap interval over runs; it is -1 to 1 if the explainable
    /// part is too small.
    ///
    /// `learned` and `before` are designs of the initial model on the training runs and on the
    /// held-out ones; `after` is the final model on the latter.
    pub fn explainable_closed(
        &self,
        [learned, before]: [&Design; 2],
        after: &ResidualModel,
        simulator: &RunSimulator,
    ) -> Interval {
        let training = &self.training;
        let prior = learned.prior();
        let products = learned.products(training);
        let noise = noise_products(learned, training, simulator, 3_000_017);
        let grams: Vec<_> = products
            .iter()
            .zip(&noise)
            .map(|(x, d)| {
                let m = x.full.ncols() - OWN_LEVELS;
                (&x.full - d)
                    .view((OWN_LEVELS, OWN_LEVELS), (m, m))
                    .into_owned()
            })
            .collect();
        let m = grams[0].ncols();
        let coefficients = explained(&grams, &prior, self.rules());
        let pair = |frame: &Frame| -> (f64, f64) {
            let x = before.columns(frame);
            let f: DVector<f64> = x.columns(OWN_LEVELS, m - 1) * &coefficients;
            let r_before = x.column(m + OWN_LEVELS - 1).into_owned();
            let r_after = DVector::from_vec(before.whitener.apply(frame, &after.residuals(frame)));
            (f.dot(&r_before), f.dot(&r_after))
        };
        let measured: Vec<(f64, f64)> = self
            .held_out
            .par_iter()
            .enumerate()
            .map(|(i, frame)| {
                let (b, a) = pair(frame);
                // A simulation of the final model has no effect to find: both products are bias.
                let simulated = simulator.pair(frame, after, 3_000_017, i);
                let bias = 0.5 * (pair(&simulated.plus).1 + pair(&simulated.minus).1)
                    - pair(&simulated.truth).1;
                (b - bias, a - bias)
            })
            .collect();
        bootstrap(&measured, self.options.seed)
    }
}

/// The closed share with its bootstrap interval over runs, by the products `f . r_before` and `f .
/// r_after` of each run.
fn bootstrap(measured: &[(f64, f64)], seed: u64) -> Interval {
    // Clipped to [-1, 1]; NaN if nothing is explainable.
    let closed = |picked: &mut dyn Iterator<Item = usize>| -> f64 {
        let (b, a) = picked.fold((0.0, 0.0), |(b, a), i| {
            (b + measured[i].0, a + measured[i].1)
        });
        if b > 0.0 {
            (1.0 - a / b).clamp(-1.0, 1.0)
        } else {
            f64::NAN
        }
    };
    let n = measured.len();
    let value = closed(&mut (0..n));
    // Bootstrap percentiles of few runs are too narrow by the ratio of Student's t to the normal
    // quantile, and by sqrt(n/(n - 1)): T. C. Hesterberg, What teachers should know about the
    // bootstrap, The American Statistician 69 (2015) 371.
    let tail = match (
        StudentsT::new(0.0, 1.0, n as f64 - 1.0),
        Normal::new(0.0, 1.0),
    ) {
        (Ok(t), Ok(normal)) => normal
            .cdf(t.inverse_cdf(0.025) * (n as f64 / (n as f64 - 1.0)).sqrt())
            .max(0.001),
        _ => 0.001,
    };
    let mut rng = stream(seed, 0xB007, 0);
    let mut values: Vec<f64> = (0..1999)
        .map(|_| {
            let picks: Vec<usize> = (0..n).map(|_| below(&mut rng, n)).collect();
            closed(&mut picks.into_iter())
        })
        .collect();
    // If the explainable part vanishes in one draw of forty, the share is unbounded.
    if value.is_nan() || values.iter().filter(|v| v.is_nan()).count() > 49 {
        return undetermined_share(if value.is_nan() { 0.0 } else { value });
    }
    values.retain(|v| !v.is_nan());
    values.sort_by(f64::total_cmp);
    let outside = (tail * values.len() as f64) as usize;
    Interval {
        value,
        low: values[outside],
        high: values[values.len() - 1 - outside],
    }
}

/// Coefficients of all columns, base first, of the part that the candidates explain given the base.
///
/// The candidates' products given the base, scaled to a unit diagonal, are decomposed into
/// principal directions. A direction is used if it is not almost collinear with others and if its
/// scores exceed two standard errors over runs: the rest would add noise to f and conceal the
/// closed share.
fn explained(grams: &[DMatrix<f64>], prior: &Prior, rules: &RunRules) -> DVector<f64> {
    let m = grams[0].ncols();
    let p = prior.count();
    let q = m - 1 - p;
    let total = grams.iter().fold(DMatrix::zeros(m, m), |sum, g| sum + g);
    let base = prior.inverse(total.view((0, 0), (p, p)).into_owned());
    // The base's part of each candidate, and of the residual.
    let of_candidates = &base * total.view((0, p), (p, q));
    let of_residual = &base * (total.view((0, m - 1), (p, 1)).column(0) + prior.scores(&prior.at));
    let free_products = total.view((p, p), (q, q)) - total.view((p, 0), (q, p)) * &of_candidates;
    let scale = DVector::from_fn(q, |c, _| {
        let own = total[(p + c, p + c)];
        if own > 0.0 { 1.0 / own.sqrt() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(q, q, |a, b| scale[a] * free_products[(a, b)] * scale[b]);
    let scaled = (&scaled + scaled.transpose()) * 0.5;
    let scores: Vec<DVector<f64>> = grams
        .iter()
        .map(|g| {
            let residual_scores = g.view((0, m - 1), (m - 1, 1)).column(0)
                - g.view((0, 0), (m - 1, p)) * &of_residual;
            let u = residual_scores.rows(p, q) - of_candidates.tr_mul(&residual_scores.rows(0, p));
            u.component_mul(&scale)
        })
        .collect();
    let mut coefficients = DVector::zeros(m - 1);
    if q == 0 {
        return coefficients;
    }
    let eigen = scaled.symmetric_eigen();
    for (k, value) in eigen.eigenvalues.iter().enumerate() {
        let along = eigen.eigenvectors.column(k);
        let of_runs = scores.iter().map(|u| along.dot(u));
        let is_significant = studentised(of_runs.clone()).abs() >= rules.explains_beyond;
        if *value < rules.explains_alone || !is_significant {
            continue;
        }
        let size = of_runs.sum::<f64>() / value;
        let candidates = along.component_mul(&scale) * size;
        let mut rows = coefficients.rows_mut(0, p);
        rows -= &of_candidates * &candidates;
        let mut rows = coefficients.rows_mut(p, q);
        rows += candidates;
    }
    coefficients
}
