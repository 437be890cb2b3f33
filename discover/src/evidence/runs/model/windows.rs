//! Windows: intervals of a track in which an effect may act.

use crate::evidence::runs::recordings::frame::Frame;

/// Widths of windows in bins.
const WIDTHS: [usize; 5] = [1, 2, 4, 8, 16];

/// An interval of a track for one of the local candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Index of the local candidate.
    pub local: usize,
    pub track: String,
    /// Start [m].
    pub from: f64,
    /// End [m].
    pub to: f64,
    /// Width of the narrowest window [m].
    pub narrowest: f64,
}

/// All windows of all widths, multiples of the narrowest [m], on all tracks, half overlapping.
pub fn windows(frames: &[Frame], locals: usize, narrowest: f64) -> Vec<Window> {
    let mut tracks: Vec<(&str, f64, f64)> = Vec::new();
    for frame in frames {
        let low = frame.s.iter().copied().fold(f64::INFINITY, f64::min);
        let high = frame.s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        match tracks.iter_mut().find(|t| t.0 == frame.track) {
            Some(t) => (t.1, t.2) = (t.1.min(low), t.2.max(high)),
            None => tracks.push((&frame.track, low, high)),
        }
    }
    let mut out = Vec::new();
    for local in 0..locals {
        for (track, low, high) in &tracks {
            // A distance above 100 km is a mistake and must not size an allocation.
            let bins = (((high - low) / narrowest).ceil() as usize).min(10_000);
            for width in WIDTHS {
                for first in (0..bins.saturating_sub(width - 1)).step_by(width.div_ceil(2)) {
                    let from = low + first as f64 * narrowest;
                    out.push(Window {
                        local,
                        track: (*track).to_owned(),
                        from,
                        to: from + width as f64 * narrowest,
                        narrowest,
                    });
                }
            }
        }
    }
    out
}
