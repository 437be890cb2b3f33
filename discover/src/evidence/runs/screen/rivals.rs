//! The class of a name: rivals beside which it does not stand out.

use crate::evidence::runs::candidates::candidate::Candidate;
use crate::evidence::runs::screen::residual_screen::Seeing;
use crate::evidence::runs::searcher::Searcher;
use crate::finding::report::Rival;

impl Searcher<'_> {
    /// The class: rivals that the named effect does not stand out beside.
    pub fn rivals(
        &self,
        seeing: &Seeing,
        list: &[Candidate],
        named: usize,
    ) -> (Vec<String>, Vec<Rival>) {
        let runs = self.training.len() as f64;
        let needed = 2.0 + 2.0 / runs.sqrt();
        let name = &list[named].effect;
        let mut class = vec![name.clone()];
        let mut rivals: Vec<Rival> = Vec::new();
        for (j, candidate) in list.iter().enumerate() {
            let s = &seeing.seen[j];
            let stranger = candidate.is_unknown() && !list[named].is_unknown();
            if candidate.effect == *name || stranger || !s.usable || s.t.abs() < 1.5 {
                continue;
            }
            let beyond = seeing.beyond(named, j);
            let sign = seeing.seen[named].t.signum();
            let correlation = seeing.correlation(named, j);
            let possible = (candidate.low..=candidate.high).contains(&s.size);
            let twin = correlation.abs() > 0.995;
            let in_class = possible
                && (twin || (beyond * sign < needed && s.gain > 0.3 * seeing.seen[named].gain));
            if in_class && !class.contains(&candidate.effect) {
                class.push(candidate.effect.clone());
            }
            rivals.push(Rival {
                effect: candidate.effect.clone(),
                parameter: candidate.key.clone(),
                size: s.size,
                unit: candidate.unit.clone(),
                t: s.t,
                gain: s.gain,
                correlation,
                t_of_named_beyond: beyond,
                in_class,
                decides: candidate.decides.clone(),
            });
        }
        rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        rivals.truncate(12);
        (class, rivals)
    }
}
