//! The class of a selected effect within runs.

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::screen::residual_screen::RunScreen;
use crate::finding::Rival;
use crate::procedure::candidate::Candidate;
use crate::procedure::rivals::NamedEffect;

impl Campaign<'_> {
    /// The class of the selected candidate `named`, and its rivals. A rival belongs to the class if
    /// the named effect is not significant given it.
    pub fn rivals(
        &self,
        screen: &RunScreen,
        list: &[Candidate<Amplitude>],
        named: usize,
    ) -> (Vec<String>, Vec<Rival>) {
        let rule = &self.rules().rivals;
        let name = &list[named].effect;
        let others = list.iter().enumerate().filter(|(j, candidate)| {
            let s = &screen.scores[*j];
            let stranger = candidate.is_column() && !list[named].is_column();
            candidate.effect != *name && !stranger && s.usable && s.t.abs() >= rule.least_t
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
