//! Detectable size of each effect, and its most similar rival.

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::screen::residual_screen::RunScreen;
use crate::finding::Detectable;
use crate::procedure::candidate::Candidate;

/// Detectable size of each usable candidate.
pub fn detectable(screen: &RunScreen, list: &[Candidate<Amplitude>]) -> Vec<Detectable> {
    let usable = |c: &usize| screen.scores[*c].usable;
    let detectable = |c: usize| {
        let others = (0..list.len()).filter(usable);
        let others = others.filter(|j| list[*j].effect != list[c].effect);
        let others = others.map(|j| (&list[j], screen.correlation(c, j)));
        let seen = &screen.scores[c];
        list[c].detectable(seen.detectable, seen.remaining_share, others)
    };
    (0..list.len()).filter(usable).map(detectable).collect()
}
