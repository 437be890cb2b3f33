//! Selection within runs: the candidate of largest gain, and its best window.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::columns::unknown;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::laws::selection::Law;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel};
use crate::evidence::runs::model::windows::{Window, windows};
use crate::evidence::runs::screen::detectable::detectable;
use crate::evidence::runs::screen::residual_screen::{
    CandidateProducts, RunScreen, ScreenOptions, best_windows, screen_runs,
};
use crate::evidence::runs::screen::track::on_track::SurveyedTrack;
use crate::evidence::runs::shared_effects::within;
use crate::options::OUTSIDE_CATALOGUE;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Randomised, Screen, Selection};
use crate::regression::scores::{Scores, cross_information};

impl Campaign<'_> {
    /// The selected effect within runs, if one is significant, and detectable sizes.
    pub fn within_runs(
        &mut self,
        at: &Current,
        track: Option<&SurveyedTrack>,
        account: &Account,
    ) -> Screen<Amplitude> {
        if at.whitener.count() == 0 {
            return Screen {
                selection: None,
                detectable: Vec::new(),
            };
        }
        let searches_outside = self.options.looks_for(OUTSIDE_CATALOGUE);
        let regular = self.everywhere(at.residual_model);
        let all_windows = windows(
            &self.training,
            self.candidates.local.len(),
            self.rules().window_m,
        );
        let design = Design {
            local: &self.candidates.local,
            windows: &all_windows,
            ..at.design(&regular)
        };
        let options = self.screen_options(at, account);
        let tested = CandidateProducts::new(&design, &self.training, at.simulator, options.pairs);
        let mut screen = screen_runs(&tested, &self.training, &options);
        let named = regular.iter().filter(|c| !c.is_column()).count();
        // If no p-value can reach the threshold, no size is detectable.
        let detectable = match self.least_p() > options.alpha {
            true => Vec::new(),
            false => detectable(&screen, &regular[..named]),
        };
        self.by_forces = regular
            .iter()
            .zip(&screen.scores)
            .filter(|(_, seen)| seen.usable && seen.remaining_share > 0.05)
            .map(|(c, seen)| (c.clone(), seen.size, seen.error))
            .collect();
        self.screen_estimates = within(&regular, &screen.scores);
        // Errors of the accelerometer are also tested in the track channel: contradicted ones are
        // neither selected nor rivals.
        for (candidate, seen) in regular.iter().zip(&mut screen.scores) {
            seen.usable &= track.is_none_or(|t| t.agrees(candidate, seen.size, seen.error));
        }
        let places = best_windows(&screen, &all_windows, regular.len());
        let selection = self.choose(at, &screen, &regular, &places, account);
        let found = self.find_contacts(at.residual_model);
        // Contacts bias the base, so that many candidates seem to explain something: the
        // significant ones are rivals.
        let largest_gain = regular
            .iter()
            .enumerate()
            .filter(|(c, candidate)| screen.is_selectable(*c, candidate, options.alpha))
            .map(|(c, _)| screen.scores[c].gain)
            .fold(0.0, f64::max);
        let required = found
            .as_ref()
            .map_or(0.0, |found| found.gain / self.rules().contacts.over);
        if let Some(found) = found.filter(|_| required > largest_gain) {
            let selection = self.select_contacts(&found);
            self.selected_contacts = Some(found);
            return Screen {
                selection,
                detectable,
            };
        }
        let law = match searches_outside {
            true => self.law(at, selection.as_ref(), &options),
            false => None,
        };
        let selection = match law {
            Some(Law::Instead(law)) => {
                self.runner_up = selection;
                Some(*law)
            }
            Some(Law::Alternative(name)) => selection.map(|mut selection| {
                selection.class.push(name);
                selection
            }),
            None => selection,
        };
        Screen {
            selection,
            detectable,
        }
    }

    /// The global candidates that are not in the model, those outside the catalogue last.
    pub fn everywhere(&self, model: &ResidualModel) -> Vec<Candidate<Amplitude>> {
        let mut regular = self.fresh(model, &self.candidates.regular);
        if self.options.looks_for(OUTSIDE_CATALOGUE) {
            regular.extend(unknown(self.data, self.model.sled.mass_kg, self.used[0]));
        }
        // A custom effect may have such a name, too.
        regular.sort_by_key(Candidate::is_column);
        regular
    }

    /// Options of a screen of a model.
    pub fn screen_options(&self, at: &Current, account: &Account) -> ScreenOptions {
        let (rules, share) = (self.rules(), self.share(account));
        ScreenOptions {
            pairs: self.options.twins.div_ceil(40).max(1),
            flips: self.options.flips,
            alpha: share * rules.alpha,
            alpha_local: share * rules.alpha,
            alpha_column: share * rules.alpha_column,
            min_shares: match at.residual_model.installation.fitted_count() {
                0 => [rules.least_left, rules.least_signal],
                _ => [rules.least_left_installed, rules.least_signal],
            },
            nine_in_ten: self.options.rules.search.nine_in_ten,
            seed: self.options.seed,
        }
    }

    /// The selected effect of a screen: one of the `regular` candidates or of the windows `places`;
    /// `None` if no one is significant.
    pub fn choose(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
        places: &[(&Window, usize)],
        account: &Account,
    ) -> Option<Selection<Amplitude>> {
        let options = self.screen_options(at, account);
        let rules = self.rules();
        let gain = |c: usize| screen.scores[c].gain;
        let alpha_of = |candidate: &Candidate<Amplitude>| match (
            &candidate.act.track,
            candidate.is_column(),
        ) {
            (_, true) => options.alpha_column,
            (Some(_), _) => options.alpha_local,
            _ => options.alpha,
        };
        let local = |window: &Window| &self.candidates.local[window.local];
        let in_windows = places.iter().map(|(window, c)| {
            let candidate = local(window).within(&window.track, window.from, window.to);
            (candidate, *c)
        });
        let everywhere = regular.iter().cloned().zip(0..);
        let largest_gain = everywhere
            .chain(in_windows)
            .filter(|(candidate, c)| screen.is_selectable(*c, candidate, alpha_of(candidate)))
            .map(|(_, c)| gain(c))
            .fold(0.0, f64::max);
        // Competing windows, with refined edges, are compared as regular candidates.
        let competing: Vec<(Candidate<Amplitude>, usize)> = places
            .iter()
            .filter(|(_, c)| largest_gain > 0.0 && gain(*c) > rules.window_competes * largest_gain)
            .map(|(window, c)| (self.refined(at, local(window), window), *c))
            .collect();
        // Candidates that may be selected or be a rival.
        let selected: Vec<usize> = (0..regular.len())
            .filter(|c| {
                screen.scores[*c].usable && screen.scores[*c].t.abs() >= rules.rivals.least_t
            })
            .collect();
        let of_kept = selected.iter().map(|c| &regular[*c]);
        let list: Vec<Candidate<Amplitude>> = of_kept
            .chain(competing.iter().map(|(candidate, _)| candidate))
            .cloned()
            .collect();
        let mut together = screen.only(&selected);
        if !competing.is_empty() {
            let design = at.design(&list);
            let noise = noise_products(&design, &self.training, at.simulator, 0);
            let grams: Vec<_> = design
                .products(&self.training)
                .iter()
                .zip(&noise)
                .map(|(p, d)| p.corrected(d))
                .collect();
            let scores = Scores::new(&grams, &design.prior());
            together.cross = cross_information(&grams, &design.prior());
            for (k, (candidate, c)) in (selected.len()..).zip(&competing) {
                together.by_run.push(&scores, k);
                let information = scores.total_information(k).max(1e-300);
                let sum = scores.sum(k);
                let mut seen = screen.scores[*c].clone();
                seen.size = sum / information * candidate.typical;
                seen.gain = sum * sum / information;
                // Its edges may now be those of an effect of the model.
                seen.usable &= scores.remaining_share(k) > options.min_shares[0];
                together.scores.push(seen);
            }
        }
        let best = |is_column: bool| {
            (0..list.len())
                .filter(|c| list[*c].is_column() == is_column)
                .filter(|c| {
                    let candidate = &list[*c];
                    together.is_selectable(*c, candidate, alpha_of(candidate))
                })
                .max_by(|a, b| {
                    together.scores[*a]
                        .gain
                        .total_cmp(&together.scores[*b].gain)
                })
        };
        // An effect of the catalogue has precedence over a column outside it, unless the column
        // explains all that the effect does, and more.
        let mut named = match (best(false), best(true)) {
            (Some(known), Some(other)) => {
                let more = together.scores[other].gain > together.scores[known].gain;
                let t = |a: usize, b: usize| together.t_given(a, b) * together.scores[a].t.signum();
                let [max_known, min_other] = rules.column_wins;
                if more && t(known, other) < max_known && t(other, known) > min_other {
                    other
                } else {
                    known
                }
            }
            (known, other) => known.or(other)?,
        };
        let (mut class, mut rivals) = self.rivals(&together, &list, named);
        // In a class of places, an effect that already acts elsewhere is the simpler explanation.
        let known = (selected.len()..list.len()).find(|c| {
            list[named].act.track.is_some()
                && *c != named
                && class.contains(&list[*c].effect)
                && account.steps.iter().any(|s| s.effect == list[*c].effect)
        });
        if let Some(known) = known {
            named = known;
            (class, rivals) = self.rivals(&together, &list, named);
        }
        let seen = &together.scores[named];
        let channel = self.strongest_channel(at.residual_model, &list[named], seen.size);
        let bias = seen.bias_t;
        let place = self.place_of(&list[named], at);
        let place = (place.as_str(), CHANNEL_NAMES[channel]);
        Some(Selection {
            class,
            rivals,
            p_value: seen.p_value,
            randomised: Randomised {
                runs: Some(seen.p_value),
                sessions: seen.p_sessions,
            },
            remark: (bias.abs() > 1.0).then(|| {
                format!(
                    "{}: the bias of noisy inputs, T = {bias:.1}, was subtracted",
                    list[named].effect
                )
            }),
            ..Selection::new(list[named].clone(), seen.size, seen.error, place)
        })
    }
}
