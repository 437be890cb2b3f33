//! A formula of a law as a custom effect.

use kufe_sled::effects::{Channel, Custom, Kind};

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::shape::{rounded, unit};
use crate::evidence::runs::laws::smooth_laws::SmoothLaw;
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
        let formula = self.simplest_formula(law)?;
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
        if !size.is_finite() || size == 0.0 {
            return None;
        }
        let (terms, shape) = (self.terms, &formula.term.shape);
        let text = shape.text(&terms.names);
        let mut known = self.at.residual_model.effects.active.iter();
        if known.any(|e| matches!(&e.kind, Kind::Custom(own) if own.text == text)) {
            return None;
        }
        let columns = shape.columns();
        let outside = columns.iter().find(|x| **x >= KNOWN);
        let carrier = outside.map(|x| terms.names[*x].clone());
        let channel = self.channels[formula.term.channel];
        let custom = Custom::new(channel, &text, carrier.as_deref())?;
        let own = match channel {
            Channel::Lateral | Channel::Longitudinal => "N",
            Channel::Yaw => "N m",
            _ => "",
        };
        let unit = unit(own, &terms.names_of(&shape.per()));
        let sizes = [size.abs(), rounded(100.0 * size.abs(), 1)];
        let columns = terms.names_of(&formula.columns);
        Some(Candidate::law(&columns, custom, carrier, &unit, sizes))
    }
}

/// The name of a law of these columns.
pub fn name(columns: &[usize], terms: &Terms) -> String {
    format!("unknown:{}", terms.names_of(columns).join("*"))
}
