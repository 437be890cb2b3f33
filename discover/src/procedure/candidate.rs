//! Candidates: one amplitude of one effect each.

use kufe_sled::effects::{Info, Parameter};

use crate::finding::{Detectable, Rival};

/// One amplitude of one effect; `A` is its action on the data at hand.
#[derive(Clone)]
pub struct Candidate<A> {
    /// Name of the effect, as in `[effects.NAME]`.
    pub effect: String,
    /// Name of the amplitude.
    pub key: String,
    pub unit: String,
    pub low: f64,
    pub high: f64,
    /// Typical order of magnitude.
    pub typical: f64,
    /// Measurement that would distinguish it from its rivals.
    pub decides: String,
    pub act: A,
}

impl<A> Candidate<A> {
    /// An amplitude of an effect of a catalogue.
    pub fn of_catalogue(info: &Info, parameter: &Parameter, act: A) -> Self {
        Self {
            effect: info.name.to_owned(),
            key: parameter.name.to_owned(),
            unit: parameter.unit.to_owned(),
            low: parameter.low,
            high: parameter.high,
            typical: parameter.typical,
            decides: info.decides.to_owned(),
            act,
        }
    }

    /// As a rival of a selected effect, uncorrelated with it; it is admissible within its bounds.
    pub fn rival(&self, size: f64, t: f64) -> Rival {
        Rival {
            effect: self.effect.clone(),
            parameter: self.key.clone(),
            size,
            unit: self.unit.clone(),
            t,
            gain: t * t,
            correlation: 0.0,
            t_of_named_beyond: 0.0,
            in_class: self.admits(size),
            decides: self.decides.clone(),
        }
    }

    /// Its detectable size, the share of it that remains after a refit of the base, and the
    /// candidate of largest correlation with it.
    pub fn detectable<'a>(
        &self,
        size: f64,
        remaining_share: f64,
        others: impl Iterator<Item = (&'a Self, f64)>,
    ) -> Detectable
    where
        A: 'a,
    {
        let most_correlated = others.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let (most_like, correlation) = most_correlated
            .map_or_else(Default::default, |(other, correlation)| {
                (other.effect.clone(), correlation)
            });
        Detectable {
            effect: self.effect.clone(),
            parameter: self.key.clone(),
            size,
            unit: self.unit.clone(),
            left_after_refit: remaining_share,
            most_like,
            correlation,
        }
    }

    /// Whether it is a dependence on a column outside the catalogue.
    pub fn is_column(&self) -> bool {
        self.effect.starts_with("unknown:")
    }

    /// Whether a size is within its bounds.
    pub fn admits(&self, size: f64) -> bool {
        (self.low..=self.high).contains(&size)
    }

    /// This candidate with another action.
    pub fn with_act<B>(&self, act: B) -> Candidate<B> {
        Candidate {
            effect: self.effect.clone(),
            key: self.key.clone(),
            unit: self.unit.clone(),
            low: self.low,
            high: self.high,
            typical: self.typical,
            decides: self.decides.clone(),
            act,
        }
    }

    /// Name with the amplitude's key.
    pub fn label(&self) -> String {
        format!("{} ({})", self.effect, self.key)
    }
}
