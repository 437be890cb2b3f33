//! Selection within runs: the candidate of largest gain, and its best window.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::candidates::columns::unknown;
use crate::evidence::runs::contacts::selection::Lever;
use crate::evidence::runs::fit::noise_products::noise_products;
use crate::evidence::runs::laws::selection::Law;
use crate::evidence::runs::model::design::{Design, Products};
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ResidualModel};
use crate::evidence::runs::model::windows::{Window, windows};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::residual_screen::{
    CandidateProducts, CandidateScore, RunScreen, ScreenOptions, best_windows, screen_runs,
};
use crate::evidence::runs::screen::track::on_track::SurveyedTrack;
use crate::evidence::runs::shared_effects::within;
use crate::finding::Rival;
use crate::options::OUTSIDE_CATALOGUE;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{Account, Randomised, Screen, Selection};
use crate::procedure::rivals::NamedEffect;
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
        let detectable = if self.least_p() > options.alpha {
            Vec::new()
        } else {
            screen.detectable(&regular[..named])
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
        let found = found.filter(|found| found.lever == Lever::Between);
        // Contacts bias the base, so that many candidates seem to explain something: the
        // significant ones are rivals.
        let significant = (0..regular.len())
            .filter(|c| screen.is_selectable(*c, &regular[*c], options.alpha))
            .map(|c| screen.scores[c].gain);
        let largest_gain = significant.fold(0.0, f64::max);
        let over = self.rules().contacts.over;
        let required = found.as_ref().map_or(0.0, |found| found.gain / over);
        if let Some(found) = found.filter(|_| required > largest_gain) {
            let selection = self.select_contacts(&found);
            self.selected_contacts = Some(found);
            return Screen {
                selection,
                detectable,
            };
        }
        let searches_outside = self.options.includes(OUTSIDE_CATALOGUE);
        let law = searches_outside.then(|| self.law(at, selection.as_ref(), &options));
        let selection = match law.flatten() {
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
        if self.options.includes(OUTSIDE_CATALOGUE) {
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
        let options = &self.screen_options(at, account);
        let (list, windows_from, together) =
            self.with_windows(at, screen, regular, places, options);
        let mut named = self.preferred(&together, &list, options)?;
        let (mut class, mut rivals) = self.rivals(&together, &list, named);
        // In a class of places, an effect that already acts elsewhere is the simpler explanation.
        let known = (windows_from..list.len()).find(|c| {
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

    /// Candidates that may be selected or be a rival, and competing windows with refined edges
    /// behind them; the index of the first window; and the screen of them all.
    fn with_windows(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
        places: &[(&Window, usize)],
        options: &ScreenOptions,
    ) -> (Vec<Candidate<Amplitude>>, usize, RunScreen) {
        let rules = self.rules();
        let gain = |c: usize| screen.scores[c].gain;
        let selectable_gain = |candidate: &Candidate<Amplitude>, c: usize| {
            let alpha = options.alpha_of(candidate);
            screen.is_selectable(c, candidate, alpha).then(|| gain(c))
        };
        let local = |window: &Window| &self.candidates.local[window.local];
        let in_windows = places.iter().filter_map(|(window, c)| {
            let candidate = local(window).within(&window.track, window.from, window.to);
            selectable_gain(&candidate, *c)
        });
        let everywhere = regular.iter().zip(0..);
        let everywhere = everywhere.filter_map(|(candidate, c)| selectable_gain(candidate, c));
        let largest_gain = everywhere.chain(in_windows).fold(0.0, f64::max);
        let least_gain = rules.window_competes * largest_gain;
        let competing: Vec<(Candidate<Amplitude>, usize)> = places
            .iter()
            .filter(|(_, c)| largest_gain > 0.0 && gain(*c) > least_gain)
            .map(|(window, c)| (self.refined(at, local(window), window), *c))
            .collect();
        let is_rival = |s: &CandidateScore| s.usable && s.t.abs() >= rules.rivals.least_t;
        let selected = (0..regular.len()).filter(|c| is_rival(&screen.scores[*c]));
        let selected: Vec<usize> = selected.collect();
        let of_selected = selected.iter().map(|c| &regular[*c]);
        let list = of_selected.chain(competing.iter().map(|(candidate, _)| candidate));
        let list: Vec<Candidate<Amplitude>> = list.cloned().collect();
        let mut together = screen.only(&selected);
        if !competing.is_empty() {
            let design = at.design(&list);
            let noise = noise_products(&design, &self.training, at.simulator, 0);
            let products = design.products(&self.training);
            let grams = products.iter().zip(&noise).map(|(p, d)| p.corrected(d));
            let grams: Vec<_> = grams.collect();
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
        (list, selected.len(), together)
    }

    /// The selectable candidate of largest gain. An effect of the catalogue has precedence over a
    /// column outside it, unless the column explains all that the effect does, and more.
    fn preferred(
        &self,
        screen: &RunScreen,
        list: &[Candidate<Amplitude>],
        options: &ScreenOptions,
    ) -> Option<usize> {
        let gain = |c: usize| screen.scores[c].gain;
        let best = |is_column: bool| {
            (0..list.len())
                .filter(|c| list[*c].is_column() == is_column)
                .filter(|c| screen.is_selectable(*c, &list[*c], options.alpha_of(&list[*c])))
                .max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
        };
        let (Some(known), Some(other)) = (best(false), best(true)) else {
            return best(false).or(best(true));
        };
        let t = |a: usize, b: usize| screen.t_given(a, b) * screen.scores[a].t.signum();
        let [max_known, min_other] = self.rules().column_wins;
        let explains_all = t(known, other) < max_known && t(other, known) > min_other;
        let wins = gain(other) > gain(known) && explains_all;
        Some(if wins { other } else { known })
    }

    /// A window of a `local` candidate with the edges of largest gain.
    fn refined(
        &self,
        at: &Current,
        local: &Candidate<Amplitude>,
        window: &Window,
    ) -> Candidate<Amplitude> {
        /// Grid of edges [m].
        const STEP: f64 = 2.5;
        /// Largest number of steps of an edge, either way.
        const MAX_STEPS: usize = 9;
        let on_track = self.training.iter().filter(|f| f.track == window.track);
        let on_track: Vec<Frame> = on_track.cloned().collect();
        let edges =
            |at: f64| (0..=2 * MAX_STEPS).map(move |k| at + (k as f64 - MAX_STEPS as f64) * STEP);
        let windows: Vec<Window> = edges(window.from)
            .flat_map(|from| edges(window.to).map(move |to| (from, to)))
            .filter(|(from, to)| to - from >= 2.0 * STEP)
            .map(|(from, to)| Window {
                local: 0,
                track: window.track.clone(),
                from,
                to,
                narrowest: STEP,
            })
            .collect();
        let design = Design {
            local: std::slice::from_ref(local),
            windows: &windows,
            ..at.design(&[])
        };
        let products = design.products(&on_track);
        let grams: Vec<_> = products.iter().map(Products::plain).collect();
        let scores = Scores::new(&grams, &design.prior());
        let gain = |w: usize| scores.sum(w).powi(2) / scores.total_information(w).max(1e-300);
        let most = (0..windows.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b)));
        let best = most.map_or(window, |w| &windows[w]);
        local.within(&best.track, best.from, best.to)
    }

    /// The class of the selected candidate `named`, and its rivals. A rival belongs to the class if
    /// the named effect is not significant given it.
    fn rivals(
        &self,
        screen: &RunScreen,
        list: &[Candidate<Amplitude>],
        named: usize,
    ) -> (Vec<String>, Vec<Rival>) {
        let rule = &self.rules().rivals;
        let name = &list[named].effect;
        let others = list.iter().enumerate().filter(|(j, candidate)| {
            let s = &screen.scores[*j];
            let is_outside = candidate.is_column() && !list[named].is_column();
            candidate.effect != *name && !is_outside && s.usable && s.t.abs() >= rule.least_t
        });
        let others = others.map(|(j, candidate)| {
            let s = &screen.scores[j];
            Rival {
                gain: s.gain,
                correlation: screen.correlation(named, j),
                t_of_named_beyond: screen.t_given(named, j),
                ..candidate.rival(s.size, s.t)
            }
        });
        rule.class(
            &NamedEffect {
                effect: name,
                t: screen.scores[named].t,
                gain: screen.scores[named].gain,
                units: self.training.len(),
            },
            others.collect(),
        )
    }
}
