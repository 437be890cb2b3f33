//! What one kind of data of a campaign tells the others.

use crate::error::Error;
use crate::finding::Fitted;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Evidence, Selection};

/// The size of one amplitude of an effect, as some data have it.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    /// Effect.
    pub effect: String,
    /// Name of the amplitude.
    pub key: String,
    /// Its unit.
    pub unit: String,
    /// Size.
    pub value: f64,
    /// Its standard error.
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

    /// Whether it is a size of the same amplitude.
    pub fn is_same(&self, other: &Self) -> bool {
        self.effect == other.effect && self.key == other.key
    }

    /// The size in its standard errors.
    pub fn t(&self) -> f64 {
        self.value / self.error.max(1e-300)
    }

    /// By how many standard errors of their difference two sizes part.
    pub fn apart(&self, other: &Self) -> f64 {
        (self.value - other.value).abs() / self.error.hypot(other.error).max(1e-300)
    }

    /// As a parameter, so many standard errors to either side.
    pub fn fitted(&self, quantile: f64) -> Fitted {
        Fitted {
            name: self.key.clone(),
            value: self.value,
            low: self.value - quantile * self.error,
            high: self.value + quantile * self.error,
            unit: self.unit.clone(),
        }
    }
}

/// What a screen shows of one candidate, selected or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Chance {
    /// Its size.
    pub amount: Amount,
    /// p-value over all candidates of its kind.
    pub p_value: f64,
}

/// Data that can be searched together with others of the same campaign. What is not said otherwise shares nothing with them.
pub trait SharesEffects: Evidence {
    /// What the last screen shows of the candidates that others may know, too.
    fn chances(&self) -> &[Chance] {
        &[]
    }

    /// Whether an effect is the same thing here as elsewhere; the air's is not that of another body.
    fn is_common(&self, _effect: &str) -> bool {
        true
    }

    /// Whether these data cannot speak of an effect because they do not have what it needs.
    fn is_untestable(&self, _effect: &str) -> bool {
        false
    }

    /// An effect that the fit has not, as a selection at a size; `None` where these data know no such effect.
    fn select(&mut self, _fit: &Self::Fit, _amount: &Amount) -> Option<Selection<Self::Act>> {
        None
    }

    /// The sizes of a step's amplitudes in a fit.
    fn amounts(&self, _fit: &Self::Fit, _step: usize) -> Vec<Amount> {
        Vec::new()
    }

    /// The fit with a step's amplitudes fixed at these sizes and everything else fitted again.
    ///
    /// # Errors
    /// Those of the fit.
    fn with_fixed_sizes(
        &mut self,
        fit: &Self::Fit,
        _step: usize,
        _amounts: &[Amount],
    ) -> Result<Self::Fit, Error> {
        Ok(fit.clone())
    }
}
