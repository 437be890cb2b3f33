//! The kinds of data of a campaign, their fits, and their estimates of one effect.

use crate::error::Result;
use crate::finding::{HeldOut, Step};
use crate::joint::combine::{disagreement, together};
use crate::joint::indexed::KindEvidence;
use crate::options::Options;
use crate::procedure::evidence::{Account, Dependence, Unexplained};
use crate::procedure::shared_effects::Amount;

/// The kind of data whose model is a case.
pub const PRESSURES: &str = "pressures";

/// One kind of data of a campaign.
pub struct Kind<'a> {
    pub name: &'static str,
    pub part: KindEvidence<'a>,
    /// Index of the fit with which its last screen selected nothing.
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
    /// Estimates by step; empty until sizes are combined.
    pub estimates: Vec<StepEstimates>,
}

/// A fit of one kind.
#[derive(Clone)]
pub struct PartFit {
    /// Index of the fit with the sizes estimated from this kind alone.
    pub free: usize,
    /// Index of the fit with the combined sizes; equal to `free` without combined sizes.
    pub written: usize,
    /// The campaign's step of each step of this kind.
    pub steps: Vec<usize>,
}

/// Estimates of a step's effect by the kinds of data.
#[derive(Clone, Default)]
pub struct StepEstimates {
    /// Sizes by kind, for the kinds that know the effect.
    pub by_kind: Vec<(usize, Vec<Amount>)>,
    /// The combined sizes, if they agree.
    pub together: Vec<Amount>,
    /// A remark if they disagree.
    pub disagreement: Option<String>,
}

/// The kind of data that selected an effect, and the index of its selection.
#[derive(Clone, Copy)]
pub struct Origin {
    pub kind: usize,
    /// Index of its selection.
    pub selection: usize,
}

impl<'a> Joint<'a> {
    /// Kinds of data with their names.
    pub fn new(parts: Vec<(&'static str, KindEvidence<'a>)>, options: &'a Options) -> Self {
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

    /// Evaluates `result` for one kind of data, with an account of the `steps` that the kind takes
    /// part in. Returns the result and these steps. The account's remarks are added to the
    /// campaign's.
    pub fn of_kind<T>(
        &mut self,
        kind: usize,
        steps: &[usize],
        account: &mut Account,
        result: impl FnOnce(&mut KindEvidence<'a>, &mut Account) -> Result<T>,
    ) -> Result<(T, Vec<Step>)> {
        let mut own = Account {
            steps: steps.iter().map(|s| account.steps[*s].clone()).collect(),
            ..Account::default()
        };
        let Kind { name, part, .. } = &mut self.kinds[kind];
        let result = result(part, &mut own)?;
        let prefixed = |text: String| format!("{name}: {text}");
        account
            .remarks
            .extend(own.remarks.into_iter().map(prefixed));
        let depends = own.depends.into_iter().map(|one| Dependence {
            assumption: prefixed(one.assumption),
            ..one
        });
        account.depends.extend(depends);
        if let Some(Unexplained { reason, decides }) = own.unexplained {
            // Reported with the names that other kinds of data have found.
            let remark = prefixed(format!("a residual remains unidentified: {reason}"));
            account.remarks.push(remark);
            account.unexplained.get_or_insert(Unexplained {
                reason: prefixed(reason),
                decides: if decides.is_empty() {
                    decides
                } else {
                    prefixed(decides)
                },
            });
        }
        Ok((result, own.steps))
    }

    /// Whether an effect is the same in all kinds of data.
    pub fn is_common(&self, effect: &str) -> bool {
        self.kinds.iter().all(|k| k.part.is_common(effect))
    }

    /// Every kind's estimates of a step's effect, and its combined size.
    pub fn estimates(&self, fit: &JointFit, step: usize, effect: &str) -> StepEstimates {
        let of_kind = |(k, part): (usize, &PartFit)| {
            let own = part.own_step(step)?;
            Some((k, self.kinds[k].part.amounts(&part.free, own)))
        };
        let by_kind: Vec<(usize, Vec<Amount>)> =
            fit.parts.iter().enumerate().filter_map(of_kind).collect();
        let mut estimates = StepEstimates {
            by_kind,
            ..StepEstimates::default()
        };
        let by_kind = &estimates.by_kind;
        if by_kind.len() < 2 || !self.is_common(effect) {
            return estimates;
        }
        let mut all: Vec<Vec<Amount>> = Vec::new();
        for amount in by_kind.iter().flat_map(|(_, amounts)| amounts) {
            match all.iter_mut().find(|same| same[0].is_same(amount)) {
                Some(same) => same.push(amount.clone()),
                None => all.push(vec![amount.clone()]),
            }
        }
        let differences = all.iter().map(|same| disagreement(same));
        let worst = differences.fold(0.0, f64::max);
        if worst <= self.options.rules.search.agree {
            estimates.together = all.iter().filter_map(|same| together(same)).collect();
            return estimates;
        }
        let name = |k: &usize| self.kinds[*k].name;
        let sizes = by_kind
            .iter()
            .flat_map(|(k, amounts)| amounts.iter().map(move |a| (k, a)))
            .map(|(k, a)| {
                let (value, error) = (a.value, a.error);
                format!(
                    "{}: {} = {value:.4e} +- {error:.1e} {}",
                    name(k),
                    a.key,
                    a.unit
                )
            });
        estimates.disagreement = Some(format!(
            "{effect}: the kinds of data disagree by {worst:.1} standard errors ({}); each keeps its own size, and the next model has that of {}",
            sizes.collect::<Vec<_>>().join("; "),
            name(&by_kind[0].0)
        ));
        estimates
    }
}

impl PartFit {
    /// This kind's index of a step of the campaign; `None` if it does not take part.
    pub fn own_step(&self, step: usize) -> Option<usize> {
        self.steps.iter().position(|s| *s == step)
    }
}

impl JointFit {
    /// Removes a step; the indices of later steps decrease by one.
    pub fn remove_step(&mut self, step: usize) {
        for part in &mut self.parts {
            part.steps.retain(|s| *s != step);
            for s in &mut part.steps {
                *s -= usize::from(*s > step);
            }
        }
    }
}
