//! Estimates that the kinds of data of a campaign share.

use crate::error::Result;
use crate::finding::{Fitted, Rival, fitted};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Evidence, Selection};

/// Estimate of one amplitude of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    pub effect: String,
    /// Name of the amplitude.
    pub key: String,
    pub unit: String,
    pub value: f64,
    pub error: f64,
}

impl Amount {
    /// A candidate at a size.
    pub fn of<A>(candidate: &Candidate<A>, value: f64, error: f64) -> Self {
        Self {
            effect: candidate.effect.clone(),
            key: candidate.key.clone(),
            unit: candidate.unit.clone(),
            value,
            error,
        }
    }

    /// A rival at its size, with this standard error.
    pub fn of_rival(rival: &Rival, error: f64) -> Self {
        Self {
            effect: rival.effect.clone(),
            key: rival.parameter.clone(),
            unit: rival.unit.clone(),
            value: rival.size,
            error,
        }
    }

    /// Whether it is an estimate of the same amplitude.
    pub fn is_same(&self, other: &Self) -> bool {
        self.effect == other.effect && self.key == other.key
    }

    /// The size in its standard errors.
    pub fn t(&self) -> f64 {
        self.value / self.error.max(1e-300)
    }

    /// Difference of two sizes, in its standard errors.
    pub fn t_difference(&self, other: &Self) -> f64 {
        (self.value - other.value).abs() / self.error.hypot(other.error).max(1e-300)
    }

    /// As a parameter with an interval of so many standard errors.
    pub fn fitted(&self, quantile: f64) -> Fitted {
        fitted(&self.key, &self.unit, self.value, quantile * self.error)
    }
}

/// Estimate and p-value of one candidate in a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct ScreenEstimate {
    pub amount: Amount,
    /// p-value over all candidates of its kind.
    pub p_value: f64,
}

/// Data that can be searched together with others; by default no effect is shared.
pub trait SharesEffects: Evidence {
    /// Results of the last screen for candidates that other kinds may share.
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        &[]
    }

    /// Whether an effect is the same in other kinds of data, which aerodynamic ones may not be.
    fn is_common(&self, _effect: &str) -> bool {
        true
    }

    /// Whether these data cannot test an effect because required columns are missing.
    fn is_untestable(&self, _effect: &str) -> bool {
        false
    }

    /// An effect that is not in the fit, as a selection at a size; `None` for an unknown effect.
    fn select(&mut self, _fit: &Self::Fit, _amount: &Amount) -> Option<Selection<Self::Act>> {
        None
    }

    /// The sizes of a step's amplitudes in a fit.
    fn amounts(&self, _fit: &Self::Fit, _step: usize) -> Vec<Amount> {
        Vec::new()
    }

    /// The fit with a step's amplitudes fixed at these sizes and everything else refitted.
    fn with_fixed_sizes(
        &mut self,
        fit: &Self::Fit,
        _step: usize,
        _amounts: &[Amount],
    ) -> Result<Self::Fit> {
        Ok(fit.clone())
    }
}
