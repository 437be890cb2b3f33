//! What could be told apart: the smallest size of each effect, and what looks most like it.

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::screen::residual_screen::Seeing;
use crate::finding::report::Detectable;
use crate::procedure::candidate::Candidate;

/// One row a candidate that can be judged.
pub fn detectable(seeing: &Seeing, list: &[Candidate<Amplitude>]) -> Vec<Detectable> {
    list.iter()
        .enumerate()
        .filter(|(c, _)| seeing.seen[*c].usable)
        .map(|(c, candidate)| {
            let like = (0..list.len())
                .filter(|j| list[*j].effect != candidate.effect && seeing.seen[*j].usable)
                .max_by(|a, b| {
                    seeing
                        .correlation(c, *a)
                        .abs()
                        .total_cmp(&seeing.correlation(c, *b).abs())
                });
            Detectable {
                effect: candidate.effect.clone(),
                parameter: candidate.key.clone(),
                size: seeing.seen[c].detectable,
                unit: candidate.unit.clone(),
                left_after_refit: seeing.seen[c].left,
                most_like: like.map_or(String::new(), |j| list[j].effect.clone()),
                correlation: like.map_or(0.0, |j| seeing.correlation(c, j)),
            }
        })
        .collect()
}
