//! Effects that resemble clocks: a force that follows late makes every channel seem late by a time of its own.
//!
//! Clocks cost the same in every run, so that no signs of runs tell. What an effect explains with clocks as they are stated, in units of
//! the noise's variance, goes as chi-squared of one degree of freedom where it is not there.

use std::sync::Arc;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::refit::Refit;
use crate::evidence::runs::laws::sums::{difference, total};
use crate::evidence::runs::recordings::noise::sensors::NoiseFrom;
use crate::evidence::runs::screen::leaders::Leader;
use crate::evidence::runs::screen::residual_screen::{RunScreen, ScreenOptions};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::Selection;

impl Campaign<'_> {
    /// Where the clocks of the channels were found to lie further apart than is stated, by more than can be believed: the effect of the
    /// catalogue with which clocks as they are stated leave no more, as far as the runs can tell, than clocks of their own do without
    /// it, selected, with what it explains. A late channel is no such effect: it is a clock. Where clocks explain far less than `contacts`, as
    /// in [`leading`](Self::leading), these come first, and clocks are tested again with them.
    pub fn instead_of_clocks(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &[Candidate<Amplitude>],
        (options, contacts): (&ScreenOptions, f64),
    ) -> Option<(Selection<Amplitude>, f64)> {
        if self.data.noise_from == NoiseFrom::Doubted
            || !at.residual_model.installation.has_own_clocks()
        {
            return None;
        }
        let bare = self.refitted_bare(at, None, f64::INFINITY)?;
        let stated = self.installed_with_stated_clocks(&bare)?;
        if !stated.model.installation.is_beyond(self.rules().belief) {
            return None;
        }
        let bare = self.misfit_by_run(&stated);
        let by_clocks = self.gains(self.refitted_alone(at)?, &bare);
        if total(&by_clocks) < self.rules().leads * contacts {
            return None;
        }
        let mut leaders = self.that_leave_least(at, screen, regular);
        for leader in &mut leaders {
            let found = self.installed_with_stated_clocks(&leader.refit)?;
            leader.refit = Arc::new(found.sized(leader.candidate)?);
            leader.gains = self.gains(&leader.refit, &bare);
        }
        let best = leaders
            .iter()
            .max_by(|a, b| total(&a.gains).total_cmp(&total(&b.gains)))?;
        let [less, error] = difference(&by_clocks, &best.gains);
        if best.candidate.act.is_delay() || less > self.rules().laws.alike * error {
            return None;
        }
        let gain = total(&best.gains);
        let tail = ChiSquared::new(1.0).map_or(1.0, |law| law.sf(gain.max(0.0)));
        let p_value = (tail * regular.len() as f64).min(1.0);
        let selection = || self.claim_of(at, screen, &leaders, best, (gain, p_value));
        (p_value <= options.alpha).then(|| (selection(), gain))
    }

    /// The candidates that leave least, refitted with nothing found of the installation.
    fn that_leave_least<'c>(
        &self,
        at: &Current,
        screen: &RunScreen,
        regular: &'c [Candidate<Amplitude>],
    ) -> Vec<Leader<'c>> {
        let most = self.rules().finalists;
        let mut leaders: Vec<Leader> = Vec::new();
        // First those that the screen says most of: what leaves more than they do is given up early.
        let named = (0..regular.len()).filter(|c| !regular[*c].is_column());
        let mut order: Vec<usize> = named.collect();
        order.sort_by(|a, b| screen.seen[*b].gain.total_cmp(&screen.seen[*a].gain));
        for c in order {
            let candidate = &regular[c];
            let last = leaders.get(most - 1);
            let beat = last.map_or(f64::INFINITY, |last| last.refit.misfit);
            let guess = (candidate, screen.seen[c].size);
            let refit: Option<Refit> = self.refitted_bare(at, Some(guess), beat);
            leaders.extend(refit.map(|refit| Leader {
                candidate,
                at: c,
                refit: Arc::new(refit),
                gains: Vec::new(),
            }));
            leaders.sort_by(|a, b| a.refit.misfit.total_cmp(&b.refit.misfit));
            leaders.truncate(most);
        }
        leaders
    }
}
