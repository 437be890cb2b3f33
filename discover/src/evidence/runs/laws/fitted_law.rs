//! A formula of a law as a custom effect.

use kufe_sled::effects::{Channel, Custom, Kind};

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formulas::formula::Formula;
use crate::evidence::runs::laws::formulas::shape::unit;
use crate::evidence::runs::laws::formulas::shapes::rounded;
use crate::evidence::runs::laws::judged::SmoothLaw;
use crate::evidence::runs::laws::sums::LawSums;
use crate::evidence::runs::laws::term::KNOWN;
use crate::evidence::runs::laws::terms::Terms;
use crate::procedure::candidate::Candidate;

/// A model with terms of laws on its channels.
pub struct LawFitter<'a> {
    pub campaign: &'a Campaign<'a>,
    pub at: &'a Current<'a>,
    /// Terms on all training runs.
    pub terms: &'a Terms<'a>,
    /// Channels that laws may act on.
    pub channels: &'a [Channel],
}

pub struct FittedLaw {
    pub formula: Formula,
    /// Its sums, then those of the named candidate.
    pub sums: LawSums,
    pub candidate: Candidate<Amplitude>,
    pub size: f64,
}

impl FittedLaw {
    /// Explained sum of squares, less a penalty for each of its numbers.
    pub fn penalised_gain(&self, number: f64) -> f64 {
        0.5 * self.formula.gain() - number * self.formula.term.shape.numbers() as f64
    }
}

impl LawFitter<'_> {
    /// The simplest formula of a smooth law.
    pub fn simplest(&self, law: &SmoothLaw) -> Option<FittedLaw> {
        let formula = self.campaign.simplest(self.terms, self.channels, law)?;
        let sums = self.terms.sums(std::slice::from_ref(&formula.term), &[1.0]);
        let sums = sums.into_iter().next()?;
        let part = sums.over(&[0], 0..sums.m.len());
        let size = part.s[0] / part.m[(0, 0)];
        let candidate = self.effect(&formula, size)?;
        Some(FittedLaw {
            formula,
            sums,
            candidate,
            size,
        })
    }

    /// The formula as a custom effect; `None` if it is not admissible or already in the model.
    fn effect(&self, formula: &Formula, size: f64) -> Option<Candidate<Amplitude>> {
        let channel = self.channels[formula.term.channel];
        let shape = &formula.term.shape;
        let text = shape.text(&self.terms.names);
        let columns = &formula.columns;
        let named = shape.columns();
        let outside = named.iter().find(|x| **x >= KNOWN);
        let carrier = outside.map(|x| self.terms.names[*x].clone());
        let custom = Custom::new(channel, &text, carrier.as_deref())?;
        let per: Vec<&str> = shape
            .per()
            .iter()
            .map(|x| self.terms.names[*x].as_str())
            .collect();
        let own = match channel {
            Channel::Lateral | Channel::Longitudinal => "N",
            Channel::Yaw => "N m",
            _ => "",
        };
        let unit = unit(own, &per);
        if !size.is_finite() || size == 0.0 {
            return None;
        }
        let limit = rounded(100.0 * size.abs(), 1);
        let known = self.at.residual_model.effects.active.iter();
        let already = known
            .filter_map(|e| match &e.kind {
                Kind::Custom(own) => Some(&own.text),
                Kind::Catalogue(_) => None,
            })
            .any(|known| *known == text);
        let columns: Vec<&str> = columns
            .iter()
            .map(|x| self.terms.names[*x].as_str())
            .collect();
        let sizes = [size.abs(), limit];
        (!already).then(|| Candidate::law(&columns, custom, carrier, &unit, sizes))
    }
}

/// The name of a law of these columns.
pub fn name(columns: &[usize], names: &[String]) -> String {
    let of: Vec<&str> = columns.iter().map(|x| names[*x].as_str()).collect();
    format!("unknown:{}", of.join("*"))
}
