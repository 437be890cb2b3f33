//! Comparison of candidates by joint fits.

use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::fit::{Fit, Setting, fit};
use crate::evidence::experiments::rows::Row;
use crate::evidence::experiments::screen::TableScreen;
use crate::finding::Rival;
use crate::procedure::candidate::Candidate;
use crate::procedure::rivals::NamedEffect;
use crate::procedure::rules::ExperimentRules;

/// A screen with the data of its joint fits.
pub struct Comparison<'a> {
    pub setting: &'a Setting,
    pub training: &'a [Row],
    pub screen: &'a TableScreen,
    /// Candidates in the model.
    pub chosen: &'a [usize],
    pub rules: &'a ExperimentRules,
}

impl Comparison<'_> {
    /// The admissible candidate with the smallest residual of a full fit. Named effects take
    /// precedence over columns that explain as much.
    pub fn strongest(&self) -> Option<usize> {
        let (screen, candidates) = (self.screen, &self.setting.candidates);
        let is_selectable: Vec<usize> = (0..candidates.len())
            .filter(|c| screen.is_selectable(*c, &candidates[*c]))
            .collect();
        let largest = is_selectable
            .iter()
            .fold(0.0_f64, |m, c| m.max(screen.t[*c].abs()));
        let chi2: Vec<(usize, f64)> = is_selectable
            .into_iter()
            .filter(|c| screen.t[*c].abs() > self.rules.near_largest * largest)
            .map(|c| (c, self.with(&[c]).chi2))
            .collect();
        let least = |by_name: bool| {
            chi2.iter()
                .filter(|(c, _)| !candidates[*c].is_column() || !by_name)
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(c, _)| *c)
        };
        let best = least(false)?;
        match least(true) {
            Some(named) if named != best => {
                let t_given = self.t_given(named, best).abs();
                Some(match t_given < self.rules.rivals.needed_t {
                    true => named,
                    false => best,
                })
            }
            _ => Some(best),
        }
    }

    /// The class of a named effect and its rivals.
    pub fn class(&self, named: usize) -> (Vec<String>, Vec<Rival>) {
        let (screen, candidates) = (self.screen, &self.setting.candidates);
        // A function of a column that the named effect uses is not a separate cause.
        let read = &candidates[named].act.columns;
        let shares_column =
            |rival: &Candidate<FrictionChange>| rival.act.columns.iter().any(|c| read.contains(c));
        let others = candidates.iter().enumerate();
        let others = others
            .filter(|(j, _)| {
                let seen = screen.t[*j].abs() >= self.rules.rivals.least_t;
                *j != named && !self.chosen.contains(j) && seen
            })
            .map(|(j, rival)| {
                let size = screen.size[j] * rival.typical;
                Rival {
                    effect: rival.effect.clone(),
                    parameter: rival.key.clone(),
                    size,
                    unit: rival.unit.clone(),
                    t: screen.t[j],
                    gain: screen.t[j].powi(2),
                    correlation: screen.correlation(named, j),
                    t_of_named_beyond: self.t_given(j, named),
                    in_class: rival.admits(size) && !(rival.is_column() && shares_column(rival)),
                    decides: rival.decides.clone(),
                }
            })
            .collect();
        let named = NamedEffect {
            effect: &candidates[named].effect,
            t: screen.t[named],
            gain: screen.t[named].powi(2),
            units: self.training.len(),
        };
        self.rules.rivals.class(&named, others)
    }

    fn with(&self, more: &[usize]) -> Fit {
        fit(self.setting, self.training, &[self.chosen, more].concat())
    }

    /// t of `one` in a fit that contains `other`; 0 if the two are collinear.
    fn t_given(&self, other: usize, one: usize) -> f64 {
        if self.screen.correlation(other, one).abs() > self.rules.rivals.alike {
            return 0.0;
        }
        let joint = self.with(&[other, one]);
        let at = self.setting.base.len() + self.chosen.len() + 1;
        let t = joint.step[at] / joint.errors[at].max(1e-300);
        if t.is_finite() { t } else { 0.0 }
    }
}
