//! Refinement of a window's edges.

use std::slice::from_ref;

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::model::design::{Design, Products};
use crate::evidence::runs::model::windows::Window;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;
use crate::regression::scores::Scores;

impl Campaign<'_> {
    /// A window of a `local` candidate with the edges of largest gain.
    pub fn refined(
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
            local: from_ref(local),
            windows: &windows,
            ..at.design(&[])
        };
        let grams: Vec<_> = design
            .products(&on_track)
            .iter()
            .map(Products::plain)
            .collect();
        let scores = Scores::new(&grams, &design.prior());
        let gain = |w: usize| scores.sum(w).powi(2) / scores.total_information(w).max(1e-300);
        let most = (0..windows.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b)));
        let best = most.map_or(window, |w| &windows[w]);
        local.within(&best.track, best.from, best.to)
    }
}
