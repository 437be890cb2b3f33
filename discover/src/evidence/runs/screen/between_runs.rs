//! Claims from session to session and from run to run.

use kufe_sled::effects::Level;

use crate::evidence::runs::candidates::candidate::Candidate;
use crate::evidence::runs::screen::levels::judge;
use crate::evidence::runs::searcher::{ALPHA_RUNS, ALPHA_SESSIONS, Pick, Searcher, Stand};
use crate::finding::report::Rival;

impl Searcher<'_> {
    pub fn between_runs(&mut self, at: &Stand, note: &mut Option<String>) -> Option<Pick> {
        let list = self.fresh(at.chain, &self.candidates.levels);
        if list.is_empty() || at.whitener.count() == 0 {
            return None;
        }
        let design = at.design(&list);
        let share = self.share();
        let alpha_of = |candidate: &Candidate| match candidate.level {
            Level::Run => share * ALPHA_RUNS,
            _ => share * ALPHA_SESSIONS,
        };
        let levels = judge(
            &design,
            self.training,
            &list,
            at.maker,
            ALPHA_SESSIONS,
            self.options.seed,
        );
        let best = (0..list.len())
            .filter(|c| {
                let s = &levels.seen[*c];
                s.p_value <= alpha_of(&list[*c]) && (list[*c].low..=list[*c].high).contains(&s.size)
            })
            .max_by(|a, b| levels.seen[*a].gain.total_cmp(&levels.seen[*b].gain));
        let Some(named) = best else {
            let differ = levels.sessions_differ.iter().copied().fold(1.0, f64::min);
            let untestable = list
                .iter()
                .zip(&levels.seen)
                .filter(|(_, s)| !s.testable)
                .count();
            if differ < 0.001 && untestable > 0 && note.is_none() {
                *note = Some(format!(
                    "sessions differ (p = {differ:.1e}), but {} sessions are too few to say with what: at least 5 at spread temperatures and humidities are needed",
                    levels.sessions
                ));
            }
            return None;
        };
        let mut class = vec![list[named].effect.clone()];
        let mut rivals = Vec::new();
        for j in (0..list.len()).filter(|j| *j != named) {
            let beyond = levels.beyond(named, j);
            let s = &levels.seen[j];
            let in_class = beyond.abs() < 2.5 && s.gain > 0.5 * levels.seen[named].gain;
            if in_class {
                class.push(list[j].effect.clone());
            }
            rivals.push(Rival {
                effect: list[j].effect.clone(),
                parameter: list[j].key.clone(),
                size: s.size,
                unit: list[j].unit.clone(),
                t: s.size / s.error.max(1e-300),
                gain: s.gain,
                correlation: s.correlation,
                t_of_named_beyond: beyond,
                in_class,
                decides: list[j].decides.clone(),
            });
        }
        let seen = &levels.seen[named];
        Some(Pick {
            place: "a level from session to session".to_owned(),
            channel: self.strongest_channel(at.chain, &list[named], seen.size),
            candidate: list[named].clone(),
            size: seen.size,
            class,
            rivals,
            p_value: seen.p_value,
            bias_t: None,
            track_error: None,
        })
    }
}
