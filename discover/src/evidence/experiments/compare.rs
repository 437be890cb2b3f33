//! Comparison of candidates by joint fits.

use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::fit::{Fit, fit};
use crate::evidence::experiments::screen::TableScreen;
use crate::finding::Rival;
use crate::procedure::evidence::Selection;
use crate::procedure::rivals::NamedEffect;
use crate::procedure::rules::ExperimentRules;

/// Where and in which channel an effect acts.
pub const EVERYWHERE: (&str, (&str, &str)) = ("all rows", ("mu", ""));

impl TableScreen<'_> {
    /// The significant candidate that explains most, with its class.
    pub fn select(&self, rules: &ExperimentRules) -> Option<Selection<FrictionChange>> {
        let named = self.strongest(rules)?;
        let (candidate, score) = (&self.setting.candidates[named], &self.scores[named]);
        // A function of a column that the named effect uses is not a separate cause.
        let read = &candidate.act.columns;
        let others = self.setting.candidates.iter().enumerate();
        let others = others.filter(|(j, _)| *j != named && !self.fit.chosen.contains(j));
        let others = others.filter(|(j, _)| self.scores[*j].t.abs() >= rules.rivals.least_t);
        let others = others.map(|(j, rival)| {
            let same_column = rival.act.columns.iter().any(|c| read.contains(c));
            let rival_of = rival.rival(self.scores[j].size, self.scores[j].t);
            Rival {
                correlation: self.correlation(named, j),
                t_of_named_beyond: self.t_given(j, named, rules),
                in_class: rival_of.in_class && !(rival.is_column() && same_column),
                ..rival_of
            }
        });
        let effect = NamedEffect {
            effect: &candidate.effect,
            t: score.t,
            gain: score.t.powi(2),
            units: self.rows.len(),
        };
        let (class, rivals) = rules.rivals.class(&effect, others.collect());
        Some(Selection {
            class,
            rivals,
            p_value: score.p_value,
            ..Selection::new(candidate.clone(), score.size, score.error, EVERYWHERE)
        })
    }

    /// The admissible candidate with the smallest residual of a full fit. Named effects take
    /// precedence over columns that explain as much.
    fn strongest(&self, rules: &ExperimentRules) -> Option<usize> {
        let admissible = self.scores.iter().enumerate();
        let significant: Vec<(usize, f64)> = admissible
            .filter(|(_, score)| score.is_admissible && score.p_value <= rules.alpha)
            .map(|(c, score)| (c, score.t.abs()))
            .collect();
        let largest = significant.iter().fold(0.0_f64, |m, (_, t)| m.max(*t));
        let near = |t: f64| t > rules.near_largest * largest;
        let near = significant.into_iter().filter(|(_, t)| near(*t));
        let chi2: Vec<(usize, f64)> = near.map(|(c, _)| (c, self.with(&[c]).chi2)).collect();
        let least = |by_name: bool| {
            chi2.iter()
                .filter(|(c, _)| !self.setting.candidates[*c].is_column() || !by_name)
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(c, _)| *c)
        };
        let best = least(false)?;
        let named = least(true).filter(|named| {
            *named == best || self.t_given(*named, best, rules).abs() < rules.rivals.needed_t
        });
        Some(named.unwrap_or(best))
    }

    fn with(&self, more: &[usize]) -> Fit {
        let chosen = [&self.fit.chosen, more].concat();
        fit(self.setting, self.rows, &chosen)
    }

    /// t of `one` in a fit that contains `other`; 0 if the two are collinear.
    fn t_given(&self, other: usize, one: usize, rules: &ExperimentRules) -> f64 {
        if self.correlation(other, one).abs() > rules.rivals.alike {
            return 0.0;
        }
        let last = self.fit.chosen.len() + 1;
        self.with(&[other, one]).t(self.setting, last)
    }
}
