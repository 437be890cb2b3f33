//! The simplest formula that is as good as the best of many.

use kufe_sled::effects::Channel;
use nalgebra::DMatrix;

use crate::evidence::runs::laws::fitted_law::LawFitter;
use crate::evidence::runs::laws::shape::{Shape, around, formulas};
use crate::evidence::runs::laws::smooth_laws::SmoothLaw;
use crate::evidence::runs::laws::sums::{LawSums, difference};
use crate::evidence::runs::laws::term::Term;

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

impl LawFitter<'_> {
    /// The simplest formula that is as good as the best of all those tried.
    pub fn simplest_formula(&self, law: &SmoothLaw) -> Option<Formula> {
        let first = law.columns.first();
        let sorted = first.map_or(Vec::new(), |column| self.terms.sorted(*column));
        let mut shapes = match law.columns.as_slice() {
            [column] => formulas(*column, &sorted),
            [a, b] => vec![Shape::Product(*a, *b)],
            _ => Vec::new(),
        };
        let forces = [Channel::Lateral, Channel::Longitudinal, Channel::Yaw];
        if forces.contains(&self.channels[law.channel]) {
            shapes.push(Shape::One);
        }
        let span = sorted.last().unwrap_or(&0.0) - sorted.first().unwrap_or(&0.0);
        let by_gain = |a: &&Formula, b: &&Formula| a.gain().total_cmp(&b.gain());
        let mut all = self.evaluated(law, shapes);
        // Each kind of formula is refined before they are compared with one another.
        for numbers in 2..=3 {
            let of_kind = all.iter().filter(|f| f.term.shape.numbers() == numbers);
            if let Some(best) = of_kind.max_by(by_gain) {
                let refined = self.refined(law, best.clone(), span);
                all.push(refined);
            }
        }
        let best = all.iter().max_by(by_gain)?.clone();
        if best.gain() <= 0.0 {
            return None;
        }
        let is_as_good = |formula: &Formula| {
            let [less, error] = difference(&best.gains, &formula.gains);
            less <= self.campaign.rules().laws.as_good * error
        };
        let good = all.into_iter().filter(is_as_good);
        good.min_by(|a, b| {
            let simpler = a.term.shape.numbers().cmp(&b.term.shape.numbers());
            simpler.then(b.gain().total_cmp(&a.gain()))
        })
    }

    /// A formula with the best parameters near its own, in steps that become smaller.
    fn refined(&self, law: &SmoothLaw, mut best: Formula, span: f64) -> Formula {
        for share in [0.06, 0.03, 0.015] {
            let near = self.evaluated(law, around(&best.term.shape, span, share));
            let found = near
                .into_iter()
                .max_by(|a, b| a.gain().total_cmp(&b.gain()));
            if let Some(found) = found.filter(|found| found.gain() > best.gain()) {
                best = found;
            }
        }
        best
    }

    /// The cross-validated gains of these shapes. As in the screen, a direction that is mostly noise
    /// is excluded.
    fn evaluated(&self, law: &SmoothLaw, shapes: Vec<Shape>) -> Vec<Formula> {
        let channel = law.channel;
        let shapes = shapes.into_iter();
        let terms: Vec<Term> = shapes.map(|shape| Term { channel, shape }).collect();
        let parts: Vec<&[Term]> = terms.chunks(32).collect();
        let [sums, plain] = &self.terms.sums_of_parts(&parts, &[1.0, 0.0])[..] else {
            return Vec::new();
        };
        let none = DMatrix::zeros(1, 1);
        let information = |sums: &LawSums, k: usize| sums.over(&[k], 0..sums.m.len()).m[(0, 0)];
        let least = self.campaign.rules().least_signal;
        let terms = terms.into_iter().enumerate();
        terms
            .filter(|(k, _)| information(sums, *k) > least * information(plain, *k))
            .map(|(k, term)| Formula {
                term,
                columns: law.columns.clone(),
                gains: sums.cross_validated_gains(&[k], &none),
            })
            .collect()
    }
}
