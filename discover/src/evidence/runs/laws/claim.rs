//! A law beyond the catalogue, claimed: a smooth one that stands out, as the simplest formula that does as well.

use kufe_sled::effects::{Channel, Custom, Kind, Level};
use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::judged::Smooth;
use crate::evidence::runs::laws::shape::unit;
use crate::evidence::runs::laws::shapes::rounded;
use crate::evidence::runs::laws::sums::{LawSums, difference, total};
use crate::evidence::runs::laws::term::COLUMNS;
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::recordings::frame::further_columns;
use crate::evidence::runs::screen::residual_screen::ScreenOptions;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Claim;

impl Campaign<'_> {
    /// The law that stands out most, where one does, explains more than the claim and leaves less, in full refits, than each of the
    /// `strongest` of the catalogue with their sizes.
    pub fn law(
        &self,
        at: &Current,
        claim: Option<&Claim<Amplitude>>,
        strongest: &[(Candidate<Amplitude>, f64)],
        options: &ScreenOptions,
    ) -> Option<Claim<Amplitude>> {
        let rules = &self.rules().laws;
        if self.least_p() > options.alpha_beyond {
            return None;
        }
        let known: Vec<Candidate<Amplitude>> = claim
            .filter(|c| c.candidate.act.carrier.is_none())
            .map(|c| c.candidate.clone())
            .into_iter()
            .collect();
        let channels = self.law_channels();
        let extra = further_columns(&self.training);
        let design = at.design(&known);
        let terms = Terms::new(&design, &self.training, at.simulator, &channels, &extra);
        let (smooth, p_value) = self.smooth_laws(&terms, &channels, options);
        let column = claim.filter(|c| c.candidate.is_column());
        let of_claim = |law: &Smooth| {
            column.is_some_and(|c| c.candidate.effect == name(&law.columns, &terms.names))
        };
        let mut best: Vec<&Smooth> = smooth
            .iter()
            .filter(|law| law.stands || of_claim(law))
            .collect();
        best.sort_by(|a, b| total(&b.gains).total_cmp(&total(&a.gains)));
        let most = total(&best.first()?.gains);
        let mut seen: Vec<&[usize]> = Vec::new();
        best.retain(|law| {
            let first = !seen.contains(&law.columns.as_slice());
            seen.push(&law.columns);
            first
        });
        best.truncate(rules.tried);
        best.retain(|law| total(&law.gains) > 0.5 * most);
        let smoothest = best.first().map(|law| law.gains.as_slice());
        let leaders: Vec<Formula> = best
            .iter()
            .filter_map(|law| self.simplest(&terms, &channels, law))
            .collect();
        let told = |formula: Formula| {
            let sums = terms.sums(std::slice::from_ref(&formula.term), &[1.0]);
            let sums = sums.into_iter().next()?;
            let shown = self.told_law(&terms, &channels, &formula, &sums, at)?;
            Some((formula, sums, shown))
        };
        let mut leaders: Vec<_> = leaders.into_iter().filter_map(told).collect();
        let size_of = |sums: &LawSums| {
            let part = sums.of(&[0], 0..sums.m.len());
            part.s[0] / part.m[(0, 0)]
        };
        let misfits: Vec<f64> = leaders
            .iter()
            .map(|(_, sums, shown)| match shown.act.carrier {
                Some(_) => f64::INFINITY,
                None => self.misfit_with(at, shown, size_of(sums)),
            })
            .collect();
        // By full refits: a large effect bends the base that scores are taken at.
        let worth = |k: usize| misfits[k] + rules.number * leaders[k].0.term.shape.numbers() as f64;
        let chosen = (0..leaders.len()).min_by(|a, b| worth(*a).total_cmp(&worth(*b)))?;
        let left = worth(chosen);
        let (formula, sums, shown) = leaders.swap_remove(chosen);
        if let Some(named) = claim {
            let gains = match known.is_empty() {
                true => return None,
                false => sums.held_gains(&[1], &DMatrix::zeros(1, 1), rules.folds),
            };
            let [more, error] = difference(&formula.gains, &gains);
            // A column's own form gives way to a formula that does as well.
            let column = named.candidate.is_column();
            let least = if column { -rules.as_good } else { rules.beats };
            if more <= least * error
                || !column && self.misfit_with(at, &named.candidate, named.size) <= left
            {
                return None;
            }
        }
        let mut known = strongest.iter();
        if shown.act.carrier.is_none()
            && known.any(|(c, size)| self.misfit_with(at, c, *size) <= left)
        {
            return None;
        }
        let class: Vec<String> = std::iter::once(shown.effect.clone())
            .chain(
                smooth
                    .iter()
                    .filter(|law| law.stands && law.columns.len() == 1)
                    .filter(|law| {
                        let [more, error] = difference(&formula.gains, &law.gains);
                        more <= rules.alike * error
                    })
                    .map(|law| name(&law.columns, &terms.names))
                    .filter(|other| shown.effect != *other && !within(&shown.effect, other)),
            )
            .fold(Vec::new(), |mut class, name| {
                if !class.contains(&name) {
                    class.push(name);
                }
                class
            });
        let size = size_of(&sums);
        let strongest = self.strongest_channel(at.residual_model, &shown, size);
        let remark = smoothest.and_then(|smooth| {
            let [more, error] = difference(smooth, &formula.gains);
            (more > rules.alike * error).then(|| {
                format!(
                    "{}: no formula that was tried does as well as a smooth curve (by {more:.0} +- {error:.0} units of the noise's variance)",
                    shown.effect
                )
            })
        });
        Some(Claim {
            place: self.place_of(&shown, at),
            channel: CHANNEL_NAMES[strongest],
            size,
            error: error_of(&sums, size),
            class,
            rivals: Vec::new(),
            p_value,
            remark,
            parameters: Vec::new(),
            candidate: shown,
        })
    }

    /// The formula as an effect of one's own.
    fn told_law(
        &self,
        terms: &Terms,
        channels: &[Channel],
        formula: &Formula,
        sums: &LawSums,
        at: &Current,
    ) -> Option<Candidate<Amplitude>> {
        let channel = channels[formula.term.channel];
        let shape = &formula.term.shape;
        let text = shape.text(&terms.names);
        let columns = &formula.columns;
        let named = shape.columns();
        let beyond = named.iter().find(|x| **x >= COLUMNS.len());
        let carrier = beyond.map(|x| terms.names[*x].clone());
        let custom = Custom::new(channel, &text, carrier.as_deref())?;
        let per: Vec<&str> = shape
            .per()
            .iter()
            .map(|x| terms.names[*x].as_str())
            .collect();
        let own = match channel {
            Channel::Lateral | Channel::Longitudinal => "N",
            Channel::Yaw => "N m",
            _ => "",
        };
        let unit = unit(own, &per);
        let part = sums.of(&[0], 0..sums.m.len());
        let size = part.s[0] / part.m[(0, 0)];
        if !size.is_finite() || size == 0.0 {
            return None;
        }
        let limit = rounded(100.0 * size.abs(), 1);
        let known = at.residual_model.effects.active.iter();
        let already = known
            .filter_map(|e| match &e.kind {
                Kind::Custom(own) => Some(&own.text),
                Kind::Catalogue(_) => None,
            })
            .any(|known| *known == text);
        (!already).then(|| Candidate {
            effect: name(columns, &terms.names),
            key: "value".to_owned(),
            unit: unit.clone(),
            low: -limit,
            high: limit,
            typical: size.abs(),
            decides: format!(
                "runs in which {} is varied by itself",
                columns
                    .iter()
                    .map(|x| terms.names[*x].as_str())
                    .collect::<Vec<_>>()
                    .join(" times ")
            ),
            act: Amplitude {
                kind: Kind::Custom(custom.bounded(&unit, -limit, limit)),
                parameter: 0,
                level: Level::Sample,
                values: vec![0.0],
                track: None,
                carrier,
            },
        })
    }
}

/// The name of a law over these columns.
fn name(columns: &[usize], names: &[String]) -> String {
    let of: Vec<&str> = columns.iter().map(|x| names[*x].as_str()).collect();
    format!("unknown:{}", of.join("*"))
}

/// Whether a law's name holds another one's column.
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
    let information = sums.of(&[0], 0..sums.m.len()).m[(0, 0)];
    (scatter * n / (n - 1.0).max(1.0) + shared).sqrt() / information
}
