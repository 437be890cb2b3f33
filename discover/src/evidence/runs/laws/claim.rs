//! A law beyond the catalogue, claimed: a smooth one that stands out, as the simplest formula that does as well.

use kufe_sled::effects::{Channel, Custom, Kind, Level};
use nalgebra::DMatrix;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::Effort;
use crate::evidence::runs::laws::formula::Formula;
use crate::evidence::runs::laws::judged::Smooth;
use crate::evidence::runs::laws::polished::{LawFit, start};
use crate::evidence::runs::laws::shape::{unit, unit_of};
use crate::evidence::runs::laws::shapes::rounded;
use crate::evidence::runs::laws::sums::{LawSums, difference, total};
use crate::evidence::runs::laws::term::KNOWN;
use crate::evidence::runs::laws::terms::Terms;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::recordings::frame::further_columns;
use crate::evidence::runs::screen::leaders::Refit;
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
        if claim.is_some() && known.is_empty() {
            return None;
        }
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
        let most = best.first().map_or(0.0, |law| total(&law.gains));
        // Of the forces, which are much alike, the one on which it explains most; each sensor by itself.
        let mut seen: Vec<(Option<usize>, &[usize])> = Vec::new();
        best.retain(|law| {
            let sensor = matches!(channels[law.channel], Channel::Sensor(_));
            let kind = (sensor.then_some(law.channel), law.columns.as_slice());
            let first = !seen.contains(&kind);
            seen.push(kind);
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
            let part = sums.of(&[0], 0..sums.m.len());
            let size = part.s[0] / part.m[(0, 0)];
            let candidate = self.told_law(&terms, &channels, &formula, size, at)?;
            // By full refits: a large effect bends the base that scores are taken at.
            let refit = match candidate.act.carrier {
                Some(_) => None,
                None => {
                    let from = start(&candidate, size);
                    self.refitted(at.residual_model, &candidate, from, Effort::LOOK)
                }
            };
            let misfit = refit.as_ref().map_or(f64::INFINITY, |refit| refit.misfit);
            let left = misfit + rules.number * formula.term.shape.numbers() as f64;
            let fit = LawFit {
                candidate,
                refit,
                size,
                left,
            };
            Some((formula, sums, fit))
        };
        let leaders: Vec<_> = leaders.into_iter().filter_map(&told).collect();
        if leaders.is_empty() && claim.is_none() && !self.is_large(at, most) {
            return None;
        }
        let without = self.refitted_alone(at.residual_model)?;
        let of_claim = known.first().zip(claim).and_then(|(known, claim)| {
            self.refitted(at.residual_model, known, claim.size, Effort::COMPARED)
        });
        let gain = |refit: &Refit| 2.0 * (without.misfit - refit.misfit);
        let most = most.max(of_claim.as_ref().map_or(0.0, gain));
        let bent = match self.is_large(at, most) {
            true => self.bent(&without, &terms, &channels, &told, options),
            false => None,
        };
        let without = without.misfit;
        let p_value = bent.as_ref().map_or(p_value, |(_, p)| p_value.min(*p));
        let leaders = leaders.into_iter().chain(bent.map(|(law, _)| law));
        let (mut formula, mut sums, mut shown) =
            leaders.min_by(|a, b| a.2.left.total_cmp(&b.2.left))?;
        // What the claim and the catalogue's strongest leave.
        let mut least = f64::INFINITY;
        let mut rivals = Vec::new();
        if shown.candidate.act.carrier.is_none() {
            let named = of_claim.as_ref().filter(|_| column.is_none());
            least = named.map_or(least, |refit| refit.misfit);
            let is_named = |c: &Candidate<Amplitude>| {
                known.iter().any(|named| {
                    (&named.effect, &named.act.track, named.act.parameter)
                        == (&c.effect, &c.act.track, c.act.parameter)
                })
            };
            let others = strongest
                .iter()
                .filter(|(c, _)| named.is_none() || !is_named(c));
            for (candidate, size) in others {
                least = least.min(self.misfit_with(at, candidate, *size));
            }
            // Nearer numbers do not double what a formula explains.
            if without - shown.left < self.rules().leads * (without - least) {
                return None;
            }
            let as_told =
                |formula: &Formula, size: f64| self.told_law(&terms, &channels, formula, size, at);
            (formula, shown) = self.polished(formula, shown, &terms, &as_told);
            // Speed and time go together: what drives a fault of a sensor shows in full refits, where each has its own numbers.
            let others: Vec<&Smooth> = smooth
                .iter()
                .filter(|law| law.channel == formula.term.channel && law.columns != formula.columns)
                .filter(|law| matches!(channels[law.channel], Channel::Sensor(_)))
                .collect();
            for law in others {
                let Some(other) = self.simplest(&terms, &channels, law).and_then(told) else {
                    continue;
                };
                let (other, its_sums, first) = other;
                if without - first.left < self.rules().leads * (without - shown.left) {
                    continue;
                }
                let (other, fitted) = self.polished(other, first, &terms, &as_told);
                if fitted.left < shown.left {
                    rivals.push((formula, shown));
                    (formula, sums, shown) = (other, its_sums, fitted);
                } else {
                    rivals.push((other, fitted));
                }
            }
        }
        let left = shown.left;
        if let Some(named) = claim {
            // A column's own form gives way to a formula that does as well.
            let beyond = match named.candidate.is_column() {
                true => -rules.as_good,
                false => rules.beats,
            };
            let [more, error] = match (&shown.refit, &of_claim) {
                (Some(law), Some(name)) => {
                    let [law, name] = [law, name].map(|refit| self.misfit_by_run(refit));
                    difference(&name, &law)
                }
                _ => {
                    let none = DMatrix::zeros(1, 1);
                    let gains = [0, 1].map(|k| sums.held_gains(&[k], &none, rules.folds));
                    difference(&gains[0], &gains[1])
                }
            };
            if more <= beyond * error {
                return None;
            }
        }
        if least <= left {
            return None;
        }
        let of_runs = |fit: &LawFit| fit.refit.as_ref().map(|refit| self.misfit_by_run(refit));
        let own = of_runs(&shown);
        let alike = |other: &LawFit| {
            let both = own.as_ref().zip(of_runs(other));
            both.is_some_and(|(own, other)| {
                let [more, error] = difference(&other, own);
                more <= rules.alike * error
            })
        };
        let same_sensor = rivals.iter().filter(|(_, fit)| alike(fit));
        let class: Vec<String> = std::iter::once(shown.candidate.effect.clone())
            .chain(same_sensor.map(|(formula, _)| name(&formula.columns, &terms.names)))
            .chain(
                smooth
                    .iter()
                    .filter(|law| law.stands && law.columns.len() == 1)
                    .filter(|law| {
                        let [more, error] = difference(&formula.gains, &law.gains);
                        more <= rules.alike * error
                    })
                    .map(|law| name(&law.columns, &terms.names))
                    .filter(|other| {
                        let of = &shown.candidate.effect;
                        of != other && !within(of, other)
                    }),
            )
            .fold(Vec::new(), |mut class, name| {
                if !class.contains(&name) {
                    class.push(name);
                }
                class
            });
        let LawFit {
            candidate: shown,
            size,
            ..
        } = shown;
        let strongest = self.strongest_channel(at.residual_model, &shown, size);
        let smoother = smoothest.and_then(|smooth| {
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
            remark: smoother,
            parameters: Vec::new(),
            candidate: shown,
        })
    }

    /// The formula as an effect of one's own; nothing where it has no size or the model has it already.
    fn told_law(
        &self,
        terms: &Terms,
        channels: &[Channel],
        formula: &Formula,
        size: f64,
        at: &Current,
    ) -> Option<Candidate<Amplitude>> {
        let channel = channels[formula.term.channel];
        let shape = &formula.term.shape;
        let text = shape.text(&terms.names);
        let columns = &formula.columns;
        let named = shape.columns();
        let beyond = named.iter().find(|x| **x >= KNOWN);
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
            Channel::Sensor(sensor) => unit_of(sensor.name()),
            _ => "",
        };
        let unit = unit(own, &per);
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
