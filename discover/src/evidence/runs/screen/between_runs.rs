//! Selection of effects between sessions and between runs.

use kufe_sled::effects::Level;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::residual_model::CHANNEL_NAMES;
use crate::evidence::runs::screen::levels::{min_p_value, screen_levels};
use crate::evidence::runs::shared_effects::between;
use crate::finding::Rival;
use crate::procedure::evidence::{Account, Randomised, Selection, Unexplained};
use crate::procedure::rivals::NamedEffect;
use crate::procedure::shared_effects::ScreenEstimate;

impl Campaign<'_> {
    /// The selected effect between sessions or runs, if any, and the estimates of every candidate.
    pub fn between_runs(
        &self,
        at: &Current,
        account: &mut Account,
    ) -> (Option<Selection<Amplitude>>, Vec<ScreenEstimate>) {
        let list = self.fresh(at.residual_model, &self.candidates.levels);
        if list.is_empty() || at.whitener.count() == 0 {
            return (None, Vec::new());
        }
        let design = at.design(&list);
        let rules = self.rules();
        let share = self.share(account);
        let levels = screen_levels(
            &design,
            &self.training,
            &list,
            at.simulator,
            self.options.seed,
        );
        let screen_estimates = between(&list, &levels.scores);
        let best = (0..list.len())
            .filter(|c| {
                let s = &levels.scores[*c];
                s.p_value <= share * rules.alpha_levels && list[*c].admits(s.size)
            })
            .max_by(|a, b| levels.scores[*a].gain.total_cmp(&levels.scores[*b].gain));
        let Some(named) = best else {
            let differ = levels.sessions_differ.iter().copied().fold(1.0, f64::min);
            let enough = |count: &usize| min_p_value(*count) <= rules.alpha_levels;
            let is_unexplained = differ < rules.alpha_column && account.unexplained.is_none();
            if is_unexplained && !enough(&levels.sessions) {
                let needed = (levels.sessions..).find(enough).unwrap_or(levels.sessions);
                account.unexplained = Some(Unexplained {
                    reason: format!(
                        "sessions differ (p = {differ:.1e}), but {} training sessions are too few to identify the cause",
                        levels.sessions
                    ),
                    decides: format!(
                        "{needed} training sessions at spread temperatures and humidities"
                    ),
                });
            }
            return (None, screen_estimates);
        };
        let others = (0..list.len()).filter(|j| *j != named).map(|j| {
            let s = &levels.scores[j];
            Rival {
                gain: s.gain,
                correlation: s.correlation,
                t_of_named_beyond: levels.t_given(named, j),
                in_class: true,
                ..list[j].rival(s.size, s.size / s.error.max(1e-300))
            }
        });
        let seen = &levels.scores[named];
        let (class, rivals) = rules.level_rivals.class(
            &NamedEffect {
                effect: &list[named].effect,
                t: seen.size / seen.error.max(1e-300),
                gain: seen.gain,
                units: levels.sessions,
            },
            others.collect(),
        );
        let channel = self.strongest_channel(at.residual_model, &list[named], seen.size);
        let place = ("a level from session to session", CHANNEL_NAMES[channel]);
        let p_value = Some(seen.p_value);
        let is_of_runs = list[named].act.level == Level::Run;
        let randomised = Randomised {
            runs: p_value.filter(|_| is_of_runs),
            sessions: p_value.filter(|_| !is_of_runs),
        };
        let selection = Selection {
            class,
            rivals,
            p_value: seen.p_value,
            randomised,
            ..Selection::new(list[named].clone(), seen.size, seen.error, place)
        };
        (Some(selection), screen_estimates)
    }
}
