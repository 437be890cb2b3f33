//! Edges of a window, found to a few metres.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::design::Products;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;
use crate::regression::scores::Scores;

impl Campaign<'_> {
    /// A window with its edges moved to where it explains most.
    pub fn refined(&self, at: &Current, candidate: &Candidate<Amplitude>) -> Candidate<Amplitude> {
        const MOVES: [f64; 7] = [-10.0, -5.0, -2.5, 0.0, 2.5, 5.0, 10.0];
        const ROUNDS: usize = 3;
        let Some(track) = &candidate.act.track else {
            return candidate.clone();
        };
        let there: Vec<Frame> = self
            .training
            .iter()
            .filter(|f| f.track == *track)
            .cloned()
            .collect();
        let mut best = candidate.clone();
        for _ in 0..ROUNDS {
            let Some((from, to)) = best.window() else {
                break;
            };
            let trials: Vec<Candidate<Amplitude>> = MOVES
                .iter()
                .flat_map(|a| MOVES.iter().map(move |b| (from + a, to + b)))
                .filter(|(a, b)| b - a >= 5.0)
                .map(|(a, b)| candidate.within(track, a, b))
                .collect();
            let design = at.design(&trials);
            let grams: Vec<_> = design
                .products(&there)
                .iter()
                .map(Products::plain)
                .collect();
            let scores = Scores::new(&grams, &design.prior());
            let gain = |c: usize| -> f64 {
                scores.sum(c).powi(2) / scores.total_information(c).max(1e-300)
            };
            let Some(most) = (0..trials.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b))) else {
                break;
            };
            let settled = trials[most].window() == Some((from, to));
            best = trials[most].clone();
            if settled {
                break;
            }
        }
        best
    }
}
