//! Quadratic fit of the coefficient of friction over the peak pressure.
//!
//! Units inside the fit are the formula's: p in MPa, mu in 1e-3, so that the coefficients read like the published ones.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use crate::friction::error::Error;
use crate::friction::estimate::student_quantile;
use crate::friction::longitudinal::mu_fit::{MuFit, Weighting};
use crate::friction::longitudinal::orthogonal_distance::Points;
use crate::friction::tables::experiments::Experiment;

/// Fits the quadratic to experiments.
///
/// `Weighting::Both` minimises `sum ((mu_i - q(xi_i))/s_mu)^2 + ((p_i - xi_i)/s_p)^2` over the coefficients and the true
/// pressures `xi_i` (P. Boggs and J. Rogers, "Orthogonal distance regression", 1990); the covariance is the
/// coefficients' block of `(J^T J)^-1` with the errors taken as stated.
///
/// # Errors
/// [`Error::TooFew`] below four experiments, [`Error::OutOfRange`] where a weighted fit meets `mu_sd = 0`,
/// [`Error::Undetermined`] below three different pressures, [`Error::NotConverged`].
pub fn fit_mu(
    experiments: &[Experiment],
    weighting: Weighting,
    confidence: f64,
) -> Result<MuFit, Error> {
    if experiments.len() < 4 {
        return Err(Error::TooFew {
            what: "mu(p) fit: experiments".into(),
            have: experiments.len(),
            need: 4,
        });
    }
    let points = Points::new(experiments);
    let freedom = experiments.len() - 3;
    let (plain, plain_inverse) = points.plain()?;
    if weighting == Weighting::None {
        let chi2 = points.squares(&plain);
        let covariance = plain_inverse * (chi2 / freedom as f64);
        let quantile = student_quantile(confidence, freedom);
        return Ok(points.result(
            plain,
            covariance,
            weighting,
            chi2,
            None,
            (confidence, quantile),
        ));
    }
    if let Some(exact) = experiments.iter().find(|e| e.mu_sd <= 0.0) {
        return Err(Error::OutOfRange {
            name: "mu_sd",
            value: exact.mu_sd,
            expected: "positive in a weighted fit",
        });
    }
    let (coefficients, inverse, chi2) = points.orthogonal(plain)?;
    let p_value = ChiSquared::new(freedom as f64).ok().map(|d| d.sf(chi2));
    let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
    Ok(points.result(
        coefficients,
        inverse,
        weighting,
        chi2,
        p_value,
        (confidence, quantile),
    ))
}
