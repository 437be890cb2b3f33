//! Joint screen of all kinds of data.
//!
//! Each member of the class of a selected effect is evaluated in every other kind that knows it.
//! That kind adds `t^2 - d^2` to its evidence (twice a log likelihood ratio), with t the size there
//! in its standard errors and d the difference of the two sizes in those of their difference.
//! Members whose evidence is below the best by more than the square of the needed t are excluded.
//! If no kind selects anything alone, p-values of the same effect are combined. Each is corrected
//! for all candidates of its kind of data, so that the combination is corrected for all, too.

use crate::error::Error;
use crate::finding::Rival;
use crate::joint::combine::{disagreement, gain};
use crate::joint::kinds::{Joint, JointFit, Origin};
use crate::null::combined_p_value;
use crate::procedure::evidence::{Account, Randomised, Selection};
use crate::procedure::shared_effects::Amount;

/// An effect of several kinds of data that none selects alone.
struct WeakEffect {
    /// Kind and size, by kind.
    by_kind: Vec<(usize, Amount)>,
    p_value: f64,
    gain: f64,
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
        let rules = &self.options.rules;
        [
            rules.runs.alpha,
            rules.runs.alpha_levels,
            rules.experiments.alpha,
        ]
        .into_iter()
        .fold(1.0, f64::min)
    }

    /// A kind's selected effect with the class given all kinds.
    pub fn judged(
        &mut self,
        fit: &JointFit,
        kind: usize,
        selection: &Selection<usize>,
    ) -> Result<Selection<Origin>, Error> {
        let own = Amount::of(&selection.candidate, selection.size, selection.error);
        let mut members = vec![(own.clone(), None::<f64>)];
        for name in &selection.class[1..] {
            let Some(rival) = selection.rivals.iter().find(|r| r.effect == *name) else {
                continue;
            };
            let error = (rival.size / rival.t).abs();
            let amount = Amount {
                effect: rival.effect.clone(),
                key: rival.parameter.clone(),
                unit: rival.unit.clone(),
                value: rival.size,
                error: if error.is_finite() { error } else { own.error },
            };
            members.push((amount, None));
        }
        let mut evaluated = false;
        for (amount, added) in &mut members {
            let mut sum = 0.0;
            let mut is_untestable = false;
            for other in (0..self.kinds.len()).filter(|k| *k != kind) {
                is_untestable |= self.kinds[other].part.is_untestable(&amount.effect);
                let Some((_, estimates)) =
                    self.estimates_of(other, fit.parts[other].free, amount)?
                else {
                    continue;
                };
                for there in estimates.iter().filter(|there| there.is_same(amount)) {
                    sum += there.t().powi(2) - there.t_difference(amount).powi(2);
                    evaluated = true;
                }
            }
            // Kinds that cannot measure an effect cannot exclude it.
            *added = (!is_untestable).then_some(sum);
        }
        let origin = |selection| Origin { kind, selection };
        if !evaluated || members.len() < 2 {
            return Ok(selection.acting(origin(selection.candidate.act)));
        }
        let of = |member: &(Amount, Option<f64>)| member.1.unwrap_or(0.0);
        let best = (1..members.len()).fold(0, |best, k| {
            match of(&members[k]) - of(&members[best]) > self.needed_t().powi(2) {
                true => k,
                false => best,
            }
        });
        let least = of(&members[best]) - self.needed_t().powi(2);
        let (named, _) = &members[best];
        let mut class = vec![named.effect.clone()];
        for member in &members {
            let stays = member.1.is_none_or(|added| added >= least);
            if stays && !class.contains(&member.0.effect) {
                class.push(member.0.effect.clone());
            }
        }
        let mut joint = match best {
            0 => selection.acting(origin(selection.candidate.act)),
            _ => match self.kinds[kind].part.select(&fit.parts[kind].free, named) {
                Some(other) => {
                    let mut other = other.acting(origin(other.candidate.act));
                    other.p_value = selection.p_value;
                    other.rivals = instead(selection, &named.effect);
                    other
                }
                None => selection.acting(origin(selection.candidate.act)),
            },
        };
        let out: Vec<&str> = members
            .iter()
            .map(|(amount, _)| amount.effect.as_str())
            .filter(|name| !class.iter().any(|c| c == name))
            .collect();
        if !out.is_empty() {
            let message = format!(
                "{} alone cannot distinguish {} from {}: the other data do",
                self.kinds[kind].name,
                out.join(", "),
                named.effect
            );
            joint.remark = Some(match joint.remark.take() {
                Some(before) => format!("{before}; {message}"),
                None => message,
            });
        }
        if class.contains(&joint.candidate.effect) {
            for rival in &mut joint.rivals {
                rival.in_class = class.contains(&rival.effect);
            }
            joint.class = class;
        }
        Ok(joint)
    }

    /// A selected effect that no kind selects alone.
    pub fn weak_together(
        &mut self,
        fit: &JointFit,
        account: &Account,
    ) -> Option<Selection<Origin>> {
        let alpha = self.alpha();
        let agree = self.options.rules.search.agree;
        let weak = self.weak();
        let known = |weak: &WeakEffect| {
            let effect = &weak.by_kind[0].1.effect;
            account.steps.iter().any(|s| s.effect == *effect)
        };
        let best = weak
            .iter()
            .filter(|w| w.by_kind.len() > 1 && w.p_value <= alpha && !known(w))
            .filter(|w| disagreement(&amounts(w)) <= agree)
            .max_by(|a, b| a.gain.total_cmp(&b.gain))?;
        let surest = best
            .by_kind
            .iter()
            .max_by(|a, b| a.1.t().abs().total_cmp(&b.1.t().abs()))?;
        let kind = surest.0;
        let selection = self.kinds[kind]
            .part
            .select(&fit.parts[kind].free, &surest.1)?;
        let mut joint = selection.acting(Origin {
            kind,
            selection: selection.candidate.act,
        });
        joint.p_value = best.p_value;
        joint.randomised = Randomised::default();
        let least = best.gain - self.needed_t().powi(2);
        for rival in weak.iter().filter(|w| w.gain >= least) {
            let effect = &rival.by_kind[0].1.effect;
            if !joint.class.contains(effect) {
                joint.class.push(effect.clone());
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
            for one in kind.part.screen_estimates() {
                let amount = one.amount.clone();
                let common = self.is_common(&amount.effect);
                let same = weak
                    .iter_mut()
                    .find(|w| common && w.by_kind[0].1.is_same(&amount));
                match same {
                    Some(same) => {
                        same.p_value = combined_p_value(same.p_value, one.p_value);
                        same.by_kind.push((k, amount));
                        same.gain = gain(&amounts(same));
                    }
                    None => weak.push(WeakEffect {
                        gain: gain(std::slice::from_ref(&amount)),
                        by_kind: vec![(k, amount)],
                        p_value: one.p_value,
                    }),
                }
            }
        }
        weak
    }
}

/// The rivals of a member named instead of a kind's own selection, which becomes one of them.
fn instead(selection: &Selection<usize>, named: &str) -> Vec<Rival> {
    let mut rivals = selection.rivals.clone();
    for rival in rivals.iter_mut().filter(|r| r.effect == named) {
        let t = selection.size / selection.error.max(1e-300);
        *rival = Rival {
            effect: selection.candidate.effect.clone(),
            parameter: selection.candidate.key.clone(),
            size: selection.size,
            unit: selection.candidate.unit.clone(),
            t,
            gain: t * t,
            t_of_named_beyond: 0.0,
            decides: selection.candidate.decides.clone(),
            ..rival.clone()
        };
    }
    rivals
}

fn amounts(weak: &WeakEffect) -> Vec<Amount> {
    weak.by_kind
        .iter()
        .map(|(_, amount)| amount.clone())
        .collect()
}
