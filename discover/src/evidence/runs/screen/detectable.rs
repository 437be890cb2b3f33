//! Detectable size of each effect, and its most similar rival.

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::screen::residual_screen::RunScreen;
use crate::finding::Detectable;
use crate::procedure::candidate::Candidate;

/// One row per candidate that can be judged.
pub fn detectable(screen: &RunScreen, list: &[Candidate<Amplitude>]) -> Vec<Detectable> {
    list.iter()
        .enumerate()
        .filter(|(c, _)| screen.seen[*c].usable)
        .map(|(c, candidate)| {
            let like = (0..list.len())
                .filter(|j| list[*j].effect != candidate.effect && screen.seen[*j].usable)
                .max_by(|a, b| {
                    screen
                        .correlation(c, *a)
                        .abs()
                        .total_cmp(&screen.correlation(c, *b).abs())
                });
            Detectable {
                effect: candidate.effect.clone(),
                parameter: candidate.key.clone(),
                size: screen.seen[c].detectable,
                unit: candidate.unit.clone(),
                left_after_refit: screen.seen[c].remaining_share,
                most_like: like.map_or(String::new(), |j| list[j].effect.clone()),
                correlation: like.map_or(0.0, |j| screen.correlation(c, j)),
            }
        })
        .collect()
}
