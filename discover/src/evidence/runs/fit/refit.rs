//! A model fitted together with an effect, and all such fits with one model.

use std::sync::{Arc, Mutex, OnceLock};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;

/// Base and effect fitted together.
#[derive(Clone)]
pub struct Refit {
    /// What they leave.
    pub misfit: f64,
    /// The effect's size.
    pub size: f64,
    /// The model, the effect last.
    pub model: ResidualModel,
    /// Its rows' whitening.
    pub whitener: Whitener,
}

impl Refit {
    /// The base, and the effects before, as they are with the effect.
    pub fn without_effect(&self) -> ResidualModel {
        let mut model = self.model.clone();
        model.effects.active.pop();
        model
    }

    /// The same with the size that its effect has as a candidate.
    pub fn sized(mut self, candidate: &Candidate<Amplitude>) -> Option<Self> {
        let last = self.model.effects.active.last()?;
        self.size = last.values[candidate.act.parameter];
        Some(self)
    }
}

/// A model on a part of the runs.
pub struct RunPart {
    /// The runs.
    pub frames: Vec<Frame>,
    /// What it leaves there, fitted.
    pub misfit: f64,
}

/// A candidate with its refit.
type Known = (Candidate<Amplitude>, Arc<Refit>);

/// Refits with one model, each made once.
#[derive(Default)]
pub struct Refits {
    few: OnceLock<Option<RunPart>>,
    alone: OnceLock<Option<Refit>>,
    with: Mutex<Vec<Known>>,
    /// Those that were given up, since they leave more than so much.
    given_up: Mutex<Vec<(Candidate<Amplitude>, f64)>>,
}

impl Refits {
    /// The model alone, as it is known or as it is made.
    pub fn alone(&self, make: impl FnOnce() -> Option<Refit>) -> Option<&Refit> {
        self.alone.get_or_init(make).as_ref()
    }

    /// The model on a few runs, as it is known or as it is made.
    pub fn on_few(&self, make: impl FnOnce() -> Option<RunPart>) -> Option<&RunPart> {
        self.few.get_or_init(make).as_ref()
    }

    /// The model with one candidate more, as it is known or as it is made, where it leaves no more than `beat`; `make` may give up where that
    /// is out of reach, or where it cannot be fitted.
    pub fn below(
        &self,
        candidate: &Candidate<Amplitude>,
        beat: f64,
        make: impl FnOnce() -> Option<Refit>,
    ) -> Option<Arc<Refit>> {
        let mut known = self.with.lock().expect("no refit panics");
        if let Some((_, refit)) = known.iter().find(|(other, _)| candidate.is(other)) {
            return Some(refit.clone()).filter(|refit| refit.misfit <= beat);
        }
        let mut given_up = self.given_up.lock().expect("no refit panics");
        let out_of_reach =
            |(other, least): &(Candidate<_>, f64)| candidate.is(other) && *least >= beat;
        if given_up.iter().any(out_of_reach) {
            return None;
        }
        let refit = make().filter(|refit| refit.misfit <= beat).map(Arc::new);
        match &refit {
            Some(refit) => known.push((candidate.clone(), refit.clone())),
            None => given_up.push((candidate.clone(), beat)),
        }
        refit
    }
}
