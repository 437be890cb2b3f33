//! Joint screen of all kinds of data.
//!
//! Each member of the class of a selected effect is evaluated in every other kind that knows it.
//! That kind adds `t^2 - d^2` to the member's evidence (twice a log-likelihood ratio), with t the
//! ratio of the size in that kind to its standard error, and d the ratio of the difference of the
//! two sizes to the standard error of the difference. Members whose evidence is below the best by
//! more than the square of the needed t are excluded. If no kind selects anything alone, p-values
//! of the same effect are combined. Each is corrected for all candidates of its kind of data, so
//! that the combination is corrected for all, too.

use crate::error::Result;
use crate::finding::Rival;
use crate::joint::combine::{disagreement, gain};
use crate::joint::kinds::{Joint, JointFit, Origin};
use crate::null::combined_p_value;
use crate::procedure::evidence::{Account, Randomised, Selection};
use crate::procedure::shared_effects::{Amount, ScreenEstimate};

/// An effect with its estimates in all kinds of data, and the combined p-value.
struct WeakEffect {
    /// Kinds that know it, and its size by each of them.
    kinds: Vec<usize>,
    amounts: Vec<Amount>,
    p_value: f64,
}

impl WeakEffect {
    fn effect(&self) -> &String {
        &self.amounts[0].effect
    }
}

/// Evidence of several kinds of data for a member of a class that another kind has determined.
struct OtherEvidence {
    /// Twice the log-likelihood ratio; `None` if one of the kinds cannot test the effect, which can
    /// then not be excluded.
    gain: Option<f64>,
    /// Whether one of the kinds has an estimate of it.
    is_estimated: bool,
}

impl Joint<'_> {
    /// t that a named effect must keep given a rival: the largest requirement of any kind.
    fn needed_t(&self) -> f64 {
        let rules = &self.options.rules;
        let (runs, levels) = (&rules.runs.rivals, &rules.runs.level_rivals);
        let needed = [runs, levels, &rules.experiments.rivals].map(|rule| rule.needed_t);
        needed.into_iter().fold(0.0, f64::max)
    }

    /// The smallest significance level of the kinds.
    fn alpha(&self) -> f64 {
        let (runs, experiments) = (&self.options.rules.runs, &self.options.rules.experiments);
        let levels = [runs.alpha, runs.alpha_levels, experiments.alpha];
        levels.into_iter().fold(1.0, f64::min)
    }

    /// A kind's selected effect, with its class determined by all kinds.
    pub fn with_joint_class(
        &mut self,
        fit: &JointFit,
        kind: usize,
        selection: &Selection<usize>,
    ) -> Result<Selection<Origin>> {
        let origin = |selection| Origin { kind, selection };
        let own = Amount::of(&selection.candidate, selection.size, selection.error);
        let rivals = selection.class[1..].iter().filter_map(|name| {
            let rival = selection.rivals.iter().find(|r| r.effect == *name)?;
            let error = (rival.size / rival.t).abs();
            let error = if error.is_finite() { error } else { own.error };
            Some(Amount::of_rival(rival, error))
        });
        let members: Vec<Amount> = [own.clone()].into_iter().chain(rivals).collect();
        let mut others = Vec::new();
        for member in &members {
            others.push(self.other_evidence(fit, kind, member)?);
        }
        let needed = self.needed_t().powi(2);
        let evidence = |k: usize| others[k].gain.unwrap_or(0.0);
        let better = |best, k| {
            let gain = evidence(k) - evidence(best);
            if gain > needed { k } else { best }
        };
        let best = (1..members.len()).fold(0, better);
        let named = &members[best];
        let unchanged = selection.with_act(origin(selection.candidate.act));
        if members.len() < 2 || !others.iter().any(|other| other.is_estimated) {
            return Ok(unchanged);
        }
        let mut class = vec![named.effect.clone()];
        for (member, other) in members.iter().zip(&others) {
            let stays = other
                .gain
                .is_none_or(|gain| gain >= evidence(best) - needed);
            if stays && !class.contains(&member.effect) {
                class.push(member.effect.clone());
            }
        }
        let free = fit.parts[kind].free;
        let other = match best {
            0 => None,
            _ => self.kinds[kind].part.select(&free, named),
        };
        let mut joint = other.map_or(unchanged, |other| Selection {
            p_value: selection.p_value,
            rivals: rivals_of_member(selection, &named.effect),
            ..other.with_act(origin(other.candidate.act))
        });
        let names = members.iter().map(|member| member.effect.as_str());
        let excluded: Vec<&str> = names
            .filter(|name| !class.iter().any(|c| c == name))
            .collect();
        if !excluded.is_empty() {
            let message = format!(
                "{} alone cannot distinguish {} from {}: the other data do",
                self.kinds[kind].name,
                excluded.join(", "),
                named.effect
            );
            let before = joint.remark.take().map(|before| format!("{before}; "));
            joint.remark = Some(before.unwrap_or_default() + &message);
        }
        if class.contains(&joint.candidate.effect) {
            for rival in &mut joint.rivals {
                rival.in_class = class.contains(&rival.effect);
            }
            joint.class = class;
        }
        Ok(joint)
    }

    /// Evidence of the kinds other than `kind` for a member of a class.
    fn other_evidence(
        &mut self,
        fit: &JointFit,
        kind: usize,
        member: &Amount,
    ) -> Result<OtherEvidence> {
        let (mut gain, mut is_untestable, mut is_estimated) = (0.0, false, false);
        for other in (0..self.kinds.len()).filter(|k| *k != kind) {
            is_untestable |= self.kinds[other].part.is_untestable(&member.effect);
            for there in self.estimates_of(other, fit.parts[other].free, member)? {
                gain += there.t().powi(2) - there.t_difference(member).powi(2);
                is_estimated = true;
            }
        }
        Ok(OtherEvidence {
            gain: (!is_untestable).then_some(gain),
            is_estimated,
        })
    }

    /// A kind's estimates of an amplitude with its fit; none of an unknown effect.
    fn estimates_of(&mut self, kind: usize, fit: usize, amount: &Amount) -> Result<Vec<Amount>> {
        const EXTRA_STEP: usize = usize::MAX;
        if !self.is_common(&amount.effect) {
            return Ok(Vec::new());
        }
        let part = &mut self.kinds[kind].part;
        let Some(selection) = part.select(&fit, amount) else {
            return Ok(Vec::new());
        };
        let added = part.add(&fit, &selection, EXTRA_STEP)?;
        let mut estimates = part.amounts(&added.fit, EXTRA_STEP);
        estimates.retain(|there| there.is_same(amount));
        Ok(estimates)
    }

    /// An effect that is significant in all kinds together, though no kind selects it alone.
    pub fn weak_together(
        &mut self,
        fit: &JointFit,
        account: &Account,
    ) -> Option<Selection<Origin>> {
        let (alpha, agree) = (self.alpha(), self.options.rules.search.agree);
        let weak = self.weak();
        let is_known =
            |weak: &&WeakEffect| account.steps.iter().any(|s| s.effect == *weak.effect());
        let best = weak
            .iter()
            .filter(|w| w.kinds.len() > 1 && w.p_value <= alpha && !is_known(w))
            .filter(|w| disagreement(&w.amounts) <= agree)
            .max_by(|a, b| gain(&a.amounts).total_cmp(&gain(&b.amounts)))?;
        let (kind, surest) = (best.kinds.iter().zip(&best.amounts))
            .max_by(|a, b| a.1.t().abs().total_cmp(&b.1.t().abs()))?;
        let part = &mut self.kinds[*kind].part;
        let selection = part.select(&fit.parts[*kind].free, surest)?;
        let mut joint = selection.with_act(Origin {
            kind: *kind,
            selection: selection.candidate.act,
        });
        joint.p_value = best.p_value;
        joint.randomised = Randomised::default();
        let min_gain = gain(&best.amounts) - self.needed_t().powi(2);
        for rival in weak.iter().filter(|w| gain(&w.amounts) >= min_gain) {
            if !joint.class.contains(rival.effect()) {
                joint.class.push(rival.effect().clone());
            }
        }
        joint.remark = Some(format!(
            "{}: no kind of data selects it alone; together they do",
            joint.candidate.effect
        ));
        Some(joint)
    }

    /// Estimates of every common amplitude in all kinds' last screens.
    fn weak(&self) -> Vec<WeakEffect> {
        let mut weak: Vec<WeakEffect> = Vec::new();
        for (k, kind) in self.kinds.iter().enumerate() {
            for ScreenEstimate { amount, p_value } in kind.part.screen_estimates().iter().cloned() {
                let common = self.is_common(&amount.effect);
                let mut known = weak.iter_mut();
                match known.find(|w| common && w.amounts[0].is_same(&amount)) {
                    Some(same) => {
                        same.p_value = combined_p_value(same.p_value, p_value);
                        same.kinds.push(k);
                        same.amounts.push(amount);
                    }
                    None => weak.push(WeakEffect {
                        kinds: vec![k],
                        amounts: vec![amount],
                        p_value,
                    }),
                }
            }
        }
        weak
    }
}

/// The rivals of a member that is named instead of the kind's own selection. The selection takes
/// the member's place among them.
fn rivals_of_member(selection: &Selection<usize>, named: &str) -> Vec<Rival> {
    let mut rivals = selection.rivals.clone();
    let t = selection.size / selection.error.max(1e-300);
    for rival in rivals.iter_mut().filter(|r| r.effect == named) {
        *rival = Rival {
            correlation: rival.correlation,
            in_class: rival.in_class,
            ..selection.candidate.rival(selection.size, t)
        };
    }
    rivals
}
