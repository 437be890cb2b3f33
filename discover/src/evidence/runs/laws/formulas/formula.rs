//! The simplest formula that is as good as the best of many.

use kufe_sled::effects::Channel;
use nalgebra::DMatrix;

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::laws::formulas::shape::Shape;
use crate::evidence::runs::laws::formulas::shapes::{around, formulas};
use crate::evidence::runs::laws::judged::SmoothLaw;
use crate::evidence::runs::laws::sums::difference;
use crate::evidence::runs::laws::term::Term;
use crate::evidence::runs::laws::terms::Terms;

/// A formula on a channel with its cross-validated gain.
#[derive(Clone)]
pub struct Formula {
    pub term: Term,
    /// Indices of the columns of the smooth law that it represents.
    pub columns: Vec<usize>,
    pub gains: Vec<f64>,
}

impl Formula {
    pub fn gain(&self) -> f64 {
        self.gains.iter().sum()
    }
}

impl Campaign<'_> {
    /// The simplest formula that is as good as the best of all those tried.
    pub fn simplest(
        &self,
        terms: &Terms,
        channels: &[Channel],
        law: &SmoothLaw,
    ) -> Option<Formula> {
        let rules = &self.rules().laws;
        let judged = |list: Vec<Term>| -> Vec<Formula> {
            let parts: Vec<&[Term]> = list.chunks(32).collect();
            let [sums, plain] = &terms.sums_of_parts(&parts, &[1.0, 0.0])[..] else {
                return Vec::new();
            };
            let none = DMatrix::zeros(1, 1);
            // As in the screen, a direction that is mostly noise is excluded.
            let [signal, all] = [sums, plain]
                .map(|sums| move |k: usize| sums.over(&[k], 0..sums.m.len()).m[(0, 0)]);
            let least = self.rules().least_signal;
            list.into_iter()
                .enumerate()
                .filter(|(k, _)| signal(*k) > least * all(*k))
                .map(|(k, term)| Formula {
                    term,
                    columns: law.columns.clone(),
                    gains: sums.cross_validated_gains(&[k], &none),
                })
                .collect()
        };
        let mut shapes = match law.columns.as_slice() {
            [column] => formulas(*column, &terms.sorted(*column)),
            [a, b] => vec![Shape::Product(*a, *b)],
            _ => Vec::new(),
        };
        let forces = [Channel::Lateral, Channel::Longitudinal, Channel::Yaw];
        if forces.contains(&channels[law.channel]) {
            shapes.push(Shape::One);
        }
        let on = |shape| Term {
            channel: law.channel,
            shape,
        };
        let span = law.columns.first().map_or(0.0, |column| {
            let sorted = terms.sorted(*column);
            sorted.last().unwrap_or(&0.0) - sorted.first().unwrap_or(&0.0)
        });
        let list = shapes.into_iter().map(on).collect();
        let mut all = judged(list);
        // Each kind of formula is refined before they are compared with one another.
        for numbers in 2..=3 {
            let of_kind = |f: &&Formula| f.term.shape.numbers() == numbers;
            let most = all
                .iter()
                .filter(of_kind)
                .max_by(|a, b| a.gain().total_cmp(&b.gain()));
            let Some(mut best) = most.cloned() else {
                continue;
            };
            for share in [0.06, 0.03, 0.015] {
                let near: Vec<Term> = around(&best.term.shape, span, share)
                    .into_iter()
                    .map(on)
                    .collect();
                if near.is_empty() {
                    break;
                }
                let near = judged(near).into_iter();
                if let Some(found) = near.max_by(|a, b| a.gain().total_cmp(&b.gain()))
                    && found.gain() > best.gain()
                {
                    best = found;
                }
            }
            all.push(best);
        }
        let best = all
            .iter()
            .max_by(|a, b| a.gain().total_cmp(&b.gain()))?
            .clone();
        if best.gain() <= 0.0 {
            return None;
        }
        all.into_iter()
            .filter(|formula| {
                let [less, error] = difference(&best.gains, &formula.gains);
                less <= rules.as_good * error
            })
            .min_by(|a, b| {
                let simpler = a.term.shape.numbers().cmp(&b.term.shape.numbers());
                simpler.then(b.gain().total_cmp(&a.gain()))
            })
    }
}
