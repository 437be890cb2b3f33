//! The kinds of data of a campaign, their fits, and their estimates of one effect.

use crate::error::Error;
use crate::finding::{Fitted, HeldOut};
use crate::joint::combine::{disagreement, together};
use crate::joint::indexed::Part;
use crate::options::Options;
use crate::procedure::evidence::{Account, Dependence};
use crate::procedure::shared_effects::Amount;

/// The kind of data whose model is a case.
pub const PRESSURES: &str = "pressures";

/// One kind of data of a campaign.
pub struct Kind<'a> {
    pub name: &'static str,
    pub part: Part<'a>,
    /// The fit with which its last screen selected nothing.
    pub silent: Option<usize>,
    /// Comparison on its held-out data.
    pub held_out: HeldOut,
}

/// Several kinds of data of one campaign.
pub struct Joint<'a> {
    /// The kinds; the first is the one whose model is written.
    pub kinds: Vec<Kind<'a>>,
    pub options: &'a Options,
}

/// A fit of every kind.
#[derive(Clone)]
pub struct JointFit {
    pub parts: Vec<PartFit>,
    /// Estimates by step, once settled.
    pub estimates: Vec<StepEstimates>,
}

/// A fit of one kind.
#[derive(Clone)]
pub struct PartFit {
    /// With its own sizes.
    pub free: usize,
    /// With the combined ones; the same without any.
    pub written: usize,
    /// The campaign's step of each of its own steps.
    pub steps: Vec<usize>,
}

/// Estimates of a step's effect by the kinds of data.
#[derive(Clone, Default)]
pub struct StepEstimates {
    /// Sizes by kind, of those that know it.
    pub by_kind: Vec<(usize, Vec<Amount>)>,
    /// The combined sizes, if they agree.
    pub together: Vec<Amount>,
    /// A remark if they disagree.
    pub disagreement: Option<String>,
}

/// Which kind selects, and its selection.
#[derive(Clone, Copy)]
pub struct Origin {
    pub kind: usize,
    /// Index of its selection.
    pub selection: usize,
}

impl<'a> Joint<'a> {
    /// Kinds of data with their names.
    pub fn new(parts: Vec<(&'static str, Part<'a>)>, options: &'a Options) -> Self {
        let kinds = parts.into_iter().map(|(name, part)| Kind {
            name,
            part,
            silent: None,
            held_out: HeldOut::default(),
        });
        Self {
            kinds: kinds.collect(),
            options,
        }
    }

    /// A kind's account: the steps that it takes part in.
    pub fn own(&self, fit: &JointFit, kind: usize, account: &Account) -> Account {
        let steps = &fit.parts[kind].steps;
        Account {
            steps: steps.iter().map(|s| account.steps[*s].clone()).collect(),
            ..Account::default()
        }
    }

    /// Adds a kind's remarks to the account.
    pub fn add_remarks(&self, kind: usize, own: Account, account: &mut Account) {
        let name = self.kinds[kind].name;
        let of = |text: String| format!("{name}: {text}");
        account.remarks.extend(own.remarks.into_iter().map(of));
        let depends = own.depends.into_iter().map(|one| Dependence {
            assumption: of(one.assumption),
            ..one
        });
        account.depends.extend(depends);
        if let Some(why) = own.unexplained {
            // Reported with the names that other kinds of data have found.
            let remark = of(format!("a residual remains unidentified: {why}"));
            account.remarks.push(remark);
            account.unexplained.get_or_insert(of(why));
        }
    }

    /// Whether an effect is the same in all kinds of data.
    pub fn is_common(&self, effect: &str) -> bool {
        self.kinds.iter().all(|k| k.part.is_common(effect))
    }

    /// A kind's estimates of an effect with its fit; `None` for an unknown effect.
    pub fn estimates_of(
        &mut self,
        kind: usize,
        fit: usize,
        amount: &Amount,
    ) -> Result<Option<(usize, Vec<Amount>)>, Error> {
        const EXTRA_STEP: usize = usize::MAX;
        if !self.is_common(&amount.effect) {
            return Ok(None);
        }
        let part = &mut self.kinds[kind].part;
        let Some(selection) = part.select(&fit, amount) else {
            return Ok(None);
        };
        let added = part.add(&fit, &selection, EXTRA_STEP)?;
        Ok(Some((added.fit, part.amounts(&added.fit, EXTRA_STEP))))
    }

    /// Every kind's estimates of a step's effect, and its combined size.
    pub fn estimates(
        &mut self,
        fit: &JointFit,
        step: usize,
        effect: &str,
    ) -> Result<StepEstimates, Error> {
        let mut estimates = StepEstimates::default();
        for (k, part) in fit.parts.iter().enumerate() {
            if let Some(own) = part.steps.iter().position(|s| *s == step) {
                let amounts = self.kinds[k].part.amounts(&part.free, own);
                estimates.by_kind.push((k, amounts));
            }
        }
        if estimates.by_kind.len() < 2 || !self.is_common(effect) {
            return Ok(estimates);
        }
        let mut all: Vec<Vec<Amount>> = Vec::new();
        for amount in estimates.by_kind.iter().flat_map(|(_, amounts)| amounts) {
            match all.iter_mut().find(|same| same[0].is_same(amount)) {
                Some(same) => same.push(amount.clone()),
                None => all.push(vec![amount.clone()]),
            }
        }
        let worst = all
            .iter()
            .map(|same| disagreement(same))
            .fold(0.0, f64::max);
        if worst <= self.options.rules.search.agree {
            estimates.together = all.iter().filter_map(|same| together(same)).collect();
        } else {
            let sizes = estimates.by_kind.iter().flat_map(|(k, amounts)| {
                let name = self.kinds[*k].name;
                amounts.iter().map(move |a| {
                    format!(
                        "{name}: {} = {:.4e} +- {:.1e} {}",
                        a.key, a.value, a.error, a.unit
                    )
                })
            });
            let sizes: Vec<String> = sizes.collect();
            estimates.disagreement = Some(format!(
                "{effect}: the kinds of data disagree by {worst:.1} standard errors ({}); each keeps its own size, and the next model has that of {}",
                sizes.join("; "),
                self.kinds[estimates.by_kind[0].0].name
            ));
        }
        Ok(estimates)
    }

    /// The parameters of a step if its kinds agree.
    pub fn combined(&self, estimates: &StepEstimates) -> Vec<Fitted> {
        let quantile = self.options.rules.search.interval;
        estimates
            .together
            .iter()
            .map(|a| a.fitted(quantile))
            .collect()
    }
}

impl JointFit {
    /// Removes a step that no kind contains; later ones move up.
    pub fn remove_step(&mut self, step: usize) {
        for part in &mut self.parts {
            part.steps.retain(|s| *s != step);
            for s in &mut part.steps {
                *s -= usize::from(*s > step);
            }
        }
        if step < self.estimates.len() {
            self.estimates.remove(step);
        }
    }
}
