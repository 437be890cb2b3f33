//! Claims within runs: the candidate that explains most, and its best window where it acts on a stretch.

use crate::evidence::runs::candidates::candidate::Candidate;
use crate::evidence::runs::candidates::columns::unknown;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::model::chain::Chain;
use crate::evidence::runs::model::design::{Design, Products};
use crate::evidence::runs::model::windows::windows;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::detectable::detectable;
use crate::evidence::runs::screen::on_track::Surveyed;
use crate::evidence::runs::screen::residual_screen::{Look, Seeing, best_windows, look};
use crate::evidence::runs::searcher::{Pick, Searcher, Stand};
use crate::regression::scores::{Scores, cross_information};

impl Searcher<'_> {
    pub fn within_runs(&mut self, at: &Stand, track: Option<&Surveyed>) -> Option<Pick> {
        if at.whitener.count() == 0 {
            return None;
        }
        let mut regular = self.fresh(at.chain, &self.candidates.regular);
        regular.extend(unknown(self.data, self.model.sled.mass_kg, self.used[0]));
        // A person's own effect may bear such a name, too.
        regular.sort_by_key(Candidate::is_unknown);
        let all_windows = windows(self.training, self.candidates.local.len());
        let design = Design {
            local: &self.candidates.local,
            windows: &all_windows,
            ..at.design(&regular)
        };
        let options = self.look_options();
        let mut seeing = look(&design, self.training, at.maker, &options);
        if self.first.is_none() {
            let named = regular.iter().filter(|c| !c.is_unknown()).count();
            self.first = Some(detectable(&seeing, &regular[..named]));
        }
        self.by_forces = regular
            .iter()
            .zip(&seeing.seen)
            .filter(|(_, seen)| seen.usable && seen.left > 0.05)
            .map(|(c, seen)| (c.clone(), seen.size, seen.error))
            .collect();
        // An accelerometer's fault shows in the track channel, too: what that contradicts is neither claimed nor a rival.
        for (candidate, seen) in regular.iter().zip(&mut seeing.seen) {
            seen.usable &= track.is_none_or(|t| t.agrees(candidate, seen.size, seen.error));
        }
        let places = best_windows(&seeing, &self.candidates.local, &all_windows, regular.len());
        self.choose(at, &seeing, &regular, &places, &options)
    }

    /// Candidates that are not already part of the chain.
    pub fn fresh(&self, chain: &Chain, list: &[Candidate]) -> Vec<Candidate> {
        list.iter()
            .filter(|c| {
                !chain.effects.active.iter().any(|e| {
                    e.effect_name() == c.effect
                        && e.track == c.track
                        && e.values[c.parameter] != 0.0
                })
            })
            .cloned()
            .collect()
    }

    pub fn choose(
        &self,
        at: &Stand,
        seeing: &Seeing,
        regular: &[Candidate],
        places: &[(Candidate, usize)],
        options: &Look,
    ) -> Option<Pick> {
        let gain = |c: usize| seeing.seen[c].gain;
        let alpha_of = |candidate: &Candidate| match (&candidate.track, candidate.is_unknown()) {
            (_, true) => options.alpha_beyond,
            (Some(_), _) => options.alpha_local,
            _ => options.alpha,
        };
        let again = |candidate: &Candidate| {
            candidate.window().is_some() && self.steps.iter().any(|s| s.effect == candidate.effect)
        };
        let most = (0..regular.len())
            .map(|c| (&regular[c], c))
            .chain(places.iter().map(|(candidate, c)| (candidate, *c)))
            .filter(|(candidate, c)| {
                seeing.claimable(*c, candidate, alpha_of(candidate), again(candidate))
            })
            .map(|(_, c)| gain(c))
            .fold(0.0, f64::max);
        // Windows that compete, with edges found to a few metres, are judged as ordinary candidates beside all others.
        let close: Vec<(Candidate, usize)> = places
            .iter()
            .filter(|(_, c)| most > 0.0 && gain(*c) > 0.3 * most)
            .map(|(candidate, c)| (self.refined(at, candidate), *c))
            .collect();
        let list: Vec<Candidate> = regular
            .iter()
            .chain(close.iter().map(|(candidate, _)| candidate))
            .cloned()
            .collect();
        let mut together = Seeing {
            seen: seeing.seen[..regular.len()].to_vec(),
            u: seeing.u.rows(0, regular.len()).into_owned(),
            cross: seeing.cross.clone(),
        };
        if !close.is_empty() {
            let design = at.design(&list);
            let noise = noise_products(&design, self.training, at.maker, 0);
            let grams: Vec<_> = design
                .products(self.training)
                .iter()
                .zip(&noise)
                .map(|(p, d)| p.corrected(d, 1.0))
                .collect();
            let scores = Scores::new(&grams, design.fitted());
            together.cross = cross_information(&grams, design.fitted());
            let rows = together.u.nrows();
            together.u = together.u.insert_rows(rows, close.len(), 0.0);
            for (k, (candidate, c)) in close.iter().enumerate() {
                together
                    .u
                    .row_mut(rows + k)
                    .copy_from(&scores.u.row(rows + k));
                let information = scores.total_information(rows + k).max(1e-300);
                let sum: f64 = scores.u.row(rows + k).sum();
                let mut seen = seeing.seen[*c].clone();
                seen.size = sum / information * candidate.typical;
                seen.gain = sum * sum / information;
                together.seen.push(seen);
            }
        }
        let best = |wanted: bool| {
            (0..list.len())
                .filter(|c| list[*c].is_unknown() == wanted)
                .filter(|c| {
                    let candidate = &list[*c];
                    together.claimable(*c, candidate, alpha_of(candidate), again(candidate))
                })
                .max_by(|a, b| together.seen[*a].gain.total_cmp(&together.seen[*b].gain))
        };
        // What the catalogue knows comes first, unless a column beyond it takes all that the name explains and more.
        let mut named = match (best(false), best(true)) {
            (Some(known), Some(other)) => {
                let more = together.seen[other].gain > together.seen[known].gain;
                let t = |a: usize, b: usize| together.beyond(a, b) * together.seen[a].t.signum();
                if more && t(known, other) < 2.0 && t(other, known) > 3.0 {
                    other
                } else {
                    known
                }
            }
            (known, other) => known.or(other)?,
        };
        let (mut class, mut rivals) = self.rivals(&together, &list, named);
        // Of a class of places, the effect that already acts elsewhere is the simpler account.
        let known = (regular.len()..list.len()).find(|c| {
            list[named].track.is_some()
                && *c != named
                && class.contains(&list[*c].effect)
                && self.steps.iter().any(|s| s.effect == list[*c].effect)
        });
        if let Some(known) = known {
            named = known;
            (class, rivals) = self.rivals(&together, &list, named);
        }
        let seen = &together.seen[named];
        Some(Pick {
            place: self.place_of(&list[named], at),
            channel: self.strongest_channel(at.chain, &list[named], seen.size),
            candidate: list[named].clone(),
            size: seen.size,
            class,
            rivals,
            p_value: seen.p_value,
            bias_t: Some(seen.bias_t),
            track_error: None,
        })
    }

    /// A window with its edges moved to where it explains most.
    pub fn refined(&self, at: &Stand, candidate: &Candidate) -> Candidate {
        const MOVES: [f64; 7] = [-10.0, -5.0, -2.5, 0.0, 2.5, 5.0, 10.0];
        const ROUNDS: usize = 3;
        let Some(track) = &candidate.track else {
            return candidate.clone();
        };
        let there: Vec<Frame> = self
            .training
            .iter()
            .filter(|f| f.track == *track)
            .cloned()
            .collect();
        let mut best = candidate.clone();
        for _ in 0..ROUNDS {
            let Some((from, to)) = best.window() else {
                break;
            };
            let trials: Vec<Candidate> = MOVES
                .iter()
                .flat_map(|a| MOVES.iter().map(move |b| (from + a, to + b)))
                .filter(|(a, b)| b - a >= 5.0)
                .map(|(a, b)| candidate.within(track, a, b))
                .collect();
            let design = at.design(&trials);
            let grams: Vec<_> = design
                .products(&there)
                .iter()
                .map(Products::plain)
                .collect();
            let scores = Scores::new(&grams, design.fitted());
            let gain = |c: usize| -> f64 {
                scores.u.row(c).sum().powi(2) / scores.total_information(c).max(1e-300)
            };
            let Some(most) = (0..trials.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b))) else {
                break;
            };
            let settled = trials[most].window() == Some((from, to));
            best = trials[most].clone();
            if settled {
                break;
            }
        }
        best
    }
}
