//! A bias of a sensor that is not there from the start: one that warms up, or drifts all along.

use kufe_sled::effects::Channel;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::fitted_law::{FittedLaw, LawFitter};
use crate::evidence::runs::laws::formulas::formula::Formula;
use crate::evidence::runs::laws::formulas::shape::Shape;
use crate::evidence::runs::laws::term::{COLUMNS, Term};
use crate::procedure::candidate::Candidate;

impl LawFitter<'_> {
    /// Where a bias of a sensor is selected, the law of that sensor over time that leaves least in a full refit: `1 - exp(-t / scale)` with an
    /// eighth, a quarter and half of the longest run, and t. Among all laws those on forces explain as much, and hide it.
    pub fn drifting(&self, selected: &Candidate<Amplitude>) -> Option<FittedLaw> {
        let own = Channel::Sensor(selected.act.biased()?);
        let channel = self.channels.iter().position(|c| *c == own)?;
        let time = COLUMNS.iter().position(|(name, _)| *name == "t_s")?;
        let longest = self.terms.sorted(time).last().copied()?;
        let warming = [0.125, 0.25, 0.5].map(|share| Shape::Approach(time, share * longest));
        let laws = warming
            .into_iter()
            .chain([Shape::Line(time)])
            .filter_map(|shape| {
                self.fit_formula(Formula {
                    term: Term { channel, shape },
                    columns: vec![time],
                    gains: Vec::new(),
                })
            });
        laws.min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }
}
