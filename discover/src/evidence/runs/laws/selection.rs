//! Selection of laws outside the catalogue, as the simplest formula of a significant smooth law.

use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::fitted_law::{FittedLaw, LawFitter, name};
use crate::evidence::runs::laws::smooth_laws::SmoothLaw;
use crate::evidence::runs::laws::sums::{LawSums, difference, total};
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::recordings::frame::further_columns;
use crate::evidence::runs::screen::residual_screen::ScreenOptions;
use crate::null::clusters::session_numbers;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Randomised, Selection};
use crate::regression::scores::Scores;

/// Result of comparing laws with a selected effect.
pub enum Law {
    /// The law is selected instead of the effect.
    Instead(Box<Selection<Amplitude>>),
    /// The name of a law that explains more, but not by enough to replace the effect.
    Alternative(String),
}

impl Campaign<'_> {
    /// The most significant law, if one explains more than the selected effect.
    pub fn law(
        &self,
        at: &Current,
        selection: Option<&Selection<Amplitude>>,
        options: &ScreenOptions,
    ) -> Option<Law> {
        let is_outside_model = selection.is_some_and(|c| c.candidate.act.carrier.is_some());
        if is_outside_model || self.least_p() > options.alpha_column {
            return None;
        }
        let rules = &self.rules().laws;
        let known: Vec<Candidate<Amplitude>> =
            selection.iter().map(|c| c.candidate.clone()).collect();
        let channels = self.law_channels();
        let extra = further_columns(&self.training, true);
        let design = at.design(&known);
        let terms = Terms::new(&design, &self.training, at.simulator, &channels, &extra);
        let fitter = LawFitter {
            campaign: self,
            at,
            terms: &terms,
            channels: &channels,
        };
        let (smooth, p_value) = self.smooth_laws(&terms, &channels, options);
        let best = fitter.best(&smooth, selection);
        let laws = best.iter().filter_map(|law| fitter.simplest(law));
        let penalised_gain = |law: &FittedLaw| law.penalised_gain(rules.number);
        let shown = laws.max_by(|a, b| penalised_gain(a).total_cmp(&penalised_gain(b)))?;
        if let Some(selection) = selection {
            let none = DMatrix::zeros(1, 1);
            let [of_law, named] = [0, 1].map(|k| shown.sums.cross_validated_gains(&[k], &none));
            let [more, error] = difference(&of_law, &named);
            if !self.is_replaced(selection, total(&named), [more, error]) {
                let is_alternative =
                    !selection.candidate.is_column() && more > rules.as_good * error;
                return is_alternative.then_some(Law::Alternative(shown.candidate.effect));
            }
        }
        let class = fitter.class(&shown, &smooth);
        let strongest = self.strongest_channel(at.residual_model, &shown.candidate, shown.size);
        let remark = best
            .first()
            .and_then(|smooth| self.smoother(smooth, &shown));
        let place = self.place_of(&shown.candidate, at);
        let place = (place.as_str(), CHANNEL_NAMES[strongest]);
        let error = error_of(&shown.sums, shown.size);
        Some(Law::Instead(Box::new(Selection {
            class,
            p_value,
            randomised: Randomised {
                runs: Some(p_value),
                sessions: self.law_by_sessions(&shown.sums),
            },
            remark,
            ..Selection::new(shown.candidate, shown.size, error, place)
        })))
    }

    /// p-value of a formula's score, the first column, with only sessions independent.
    fn law_by_sessions(&self, sums: &LawSums) -> Option<f64> {
        let first = |rows: &DMatrix<f64>| rows.rows(0, 1).into_owned();
        let scores = Scores {
            u: first(&sums.u),
            information: DMatrix::from_fn(1, sums.m.len(), |_, run| sums.m[run][(0, 0)]),
            raw: Vec::new(),
            shared: vec![sums.shared[0]],
            common: first(&sums.common),
        };
        let sessions = session_numbers(self.training.iter().map(|frame| frame.session.as_str()));
        let of_sessions = scores.by_sessions(&sessions)?;
        let null = of_sessions.by_wild_bootstrap(self.options.flips, self.options.seed);
        of_sessions.t().first().map(|t| null.p_value(*t))
    }

    /// Whether a law replaces a selected effect. `more` is the difference of their gains, `error`
    /// its standard error and `explained` the effect's gain. An effect of the catalogue is replaced
    /// if the law explains clearly more, by a material share of `explained`; the form of a column
    /// outside it is replaced by an equivalent formula.
    fn is_replaced(
        &self,
        selection: &Selection<Amplitude>,
        explained: f64,
        [more, error]: [f64; 2],
    ) -> bool {
        let (rules, search) = (&self.rules().laws, &self.options.rules.search);
        let (errors, min_gain) = if selection.candidate.is_column() {
            (-rules.as_good, f64::NEG_INFINITY)
        } else {
            (search.clear, search.material * explained)
        };
        more > errors * error && more > min_gain
    }

    /// A remark if a smooth curve explains more than the formula.
    fn smoother(&self, smooth: &SmoothLaw, law: &FittedLaw) -> Option<String> {
        let [more, error] = difference(&smooth.gains, &law.formula.gains);
        (more > self.rules().laws.alike * error).then(|| {
            format!(
                "{}: no formula that was tried does as well as a smooth curve (by {more:.0} +- {error:.0} units of the noise's variance)",
                law.candidate.effect
            )
        })
    }
}

impl LawFitter<'_> {
    /// The smooth laws whose formulas are tried, largest gain first: the significant laws, the law
    /// of a selected column, and the laws that explain more than it or than all significant ones.
    fn best<'l>(
        &self,
        smooth: &'l [SmoothLaw],
        selection: Option<&Selection<Amplitude>>,
    ) -> Vec<&'l SmoothLaw> {
        let column = selection.filter(|c| c.candidate.is_column());
        let is_selected = |law: &SmoothLaw| {
            column.is_some_and(|c| c.candidate.effect == name(&law.columns, self.terms))
        };
        let selected = smooth.iter().filter(|law| is_selected(law));
        let enough = selected
            .map(|law| total(&law.gains))
            .fold(f64::INFINITY, f64::min)
            .max(0.0);
        // If one law is significant, laws that explain more are tried, too.
        let significant = smooth.iter().filter(|law| law.significant);
        let largest = significant.map(|law| total(&law.gains)).reduce(f64::max);
        let rivals = |law: &SmoothLaw| largest.is_some_and(|m| total(&law.gains) > m);
        let requested = |law: &SmoothLaw| is_selected(law) || total(&law.gains) > enough;
        let mut best: Vec<&SmoothLaw> = smooth
            .iter()
            .filter(|law| law.significant || rivals(law) || requested(law))
            .collect();
        best.sort_by(|a, b| total(&b.gains).total_cmp(&total(&a.gains)));
        let most = best.first().map_or(0.0, |law| total(&law.gains));
        // Channels are strongly correlated: only the one of largest gain is tried.
        let mut seen: Vec<&[usize]> = Vec::new();
        best.retain(|law| {
            let first = !seen.contains(&law.columns.as_slice());
            seen.push(&law.columns);
            first
        });
        best.truncate(self.campaign.rules().laws.tried);
        best.retain(|law| total(&law.gains) > 0.5 * most);
        best
    }

    /// The law's name, then the names of laws that the data cannot distinguish from it.
    fn class(&self, law: &FittedLaw, smooth: &[SmoothLaw]) -> Vec<String> {
        let (own, own_columns) = (&law.candidate.effect, &law.formula.columns);
        let alike = self.campaign.rules().laws.alike;
        let alike = |[more, error]: [f64; 2]| more <= alike * error;
        // If no law is significant by itself, as with unknown noise, all laws of equal gain count.
        let any = !smooth.iter().any(|other| other.significant);
        let tested = smooth.iter().filter(|other| other.significant || any);
        let single = tested
            .clone()
            .filter(|other| other.columns.len() == 1)
            .filter(|other| total(&other.gains) > 0.0)
            .filter(|other| alike(difference(&law.formula.gains, &other.gains)))
            .map(|other| &other.columns);
        // A product with the law's own column is included if it explains more.
        let products = tested
            .filter(|other| other.columns.len() == 2)
            .filter(|other| own_columns.iter().all(|x| other.columns.contains(x)))
            .filter(|other| total(&other.gains) > total(&law.formula.gains))
            .map(|other| &other.columns);
        let named = |columns: &Vec<usize>| name(columns, self.terms);
        let alone = single.chain(products).map(named);
        let others = alone.filter(|other| !within(own, other));
        let mut class = vec![own.clone()];
        for other in others {
            if !class.contains(&other) {
                class.push(other);
            }
        }
        class
    }
}

/// Whether a law's name contains another one's column.
fn within(law: &str, other: &str) -> bool {
    let column = other.strip_prefix("unknown:").unwrap_or(other);
    law.strip_prefix("unknown:")
        .is_some_and(|columns| columns.split('*').any(|c| c == column))
}

/// Standard error of the first column's size, from the scatter of runs.
fn error_of(sums: &LawSums, size: f64) -> f64 {
    let n = sums.m.len() as f64;
    let scatter: f64 = (0..sums.m.len())
        .map(|i| (sums.u[(0, i)] - size * sums.m[i][(0, 0)]).powi(2))
        .sum();
    let shared = sums.common.row(0).norm_squared();
    let information = sums.over(&[0], 0..sums.m.len()).m[(0, 0)];
    (scatter * n / (n - 1.0).max(1.0) + shared).sqrt() / information
}
