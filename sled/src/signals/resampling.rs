//! The even times that a run is brought to.

use std::ops::Range;

use crate::record::check::needs::Needs;
use crate::record::run::Run;
use crate::signals::derivative::HALF_WIDTH;
use crate::signals::filter::{ratio, resample_from};

/// How a run is brought to the rate that everything else works at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrepareOptions {
    /// Rate after down-sampling [Hz]; a slower recording stays as it is.
    pub rate_hz: f64,
    /// Corner of the zero-phase low pass after that [Hz].
    pub cutoff_hz: f64,
    /// What it is for.
    pub needs: Needs,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        PrepareOptions {
            rate_hz: 100.0,
            cutoff_hz: 20.0,
            needs: Needs::FORCES,
        }
    }
}

/// The even times at the lower rate, and what stands beside a gap.
pub(crate) struct Resampling {
    /// Rate of the recording [Hz].
    pub(crate) from_hz: f64,
    /// Rate of the states [Hz].
    pub(crate) rate_hz: f64,
    /// Samples of the recording a state.
    pub(crate) ratio: f64,
    /// Corner of the low pass at that rate [Hz].
    pub(crate) cutoff_hz: f64,
    /// Corner of the narrower of both low passes [Hz].
    pub(crate) narrowest_hz: f64,
    /// States beside a gap that take no part.
    pub(crate) margin: usize,
}

impl Resampling {
    pub(crate) fn of(run: &Run, options: &PrepareOptions) -> Resampling {
        let from = run.rate_hz();
        let lower = options.rate_hz < from * (1.0 - 1e-3);
        let rate = if lower { options.rate_hz } else { from };
        let narrowest_hz = options
            .cutoff_hz
            .min(if lower { 0.4 * rate } else { f64::INFINITY });
        let periods = if narrowest_hz < 0.5 * from {
            (2.0 * rate / narrowest_hz).ceil() as usize
        } else {
            0
        };
        Resampling {
            from_hz: from,
            rate_hz: rate,
            ratio: if lower { ratio(from, rate) } else { 1.0 },
            cutoff_hz: options.cutoff_hz,
            narrowest_hz,
            margin: periods + HALF_WIDTH,
        }
    }

    /// The states, counted from the first sample of the run, that lie in a stretch of the recording.
    pub(crate) fn samples(&self, piece: &Range<usize>) -> Range<usize> {
        let first = (piece.start as f64 / self.ratio - 1e-9).ceil() as usize;
        first..((piece.end - 1) as f64 / self.ratio + 1e-9).floor() as usize + 1
    }

    /// A stretch of a column at the rate of the states.
    pub(crate) fn resampled(&self, column: &[f64], piece: &Range<usize>) -> Vec<f64> {
        let first = self.samples(piece).start as f64 * self.ratio;
        let offset = first - piece.start as f64;
        resample_from(&column[piece.clone()], self.from_hz, self.rate_hz, offset)
    }

    /// Which of the `count` states of stretch `number` of `stretches` take part: those beside a gap do not.
    pub(crate) fn kept(&self, number: usize, stretches: usize, count: usize) -> Range<usize> {
        let from = if number == 0 { 0 } else { self.margin };
        let beyond = if number + 1 == stretches {
            0
        } else {
            self.margin
        };
        from..count.saturating_sub(beyond).max(from)
    }
}
