//! A series as a smooth function of time.

use kufe_sled::{Spline, low_pass};

use crate::clock::series::Series;
use crate::resample::stretches;

/// Fewest samples of a stretch that serve.
const LEAST: usize = 16;

/// A low-passed series as a cubic spline in each stretch without a gap.
pub(crate) struct Signal {
    parts: Vec<(f64, f64, Spline)>,
    /// The series' own rate [Hz].
    pub rate_hz: f64,
}

impl Signal {
    /// A series through a zero-phase low pass; `None` where no stretch is long enough.
    pub fn of(series: &Series, corner_hz: f64) -> Option<Signal> {
        let cut = stretches(&series.time, &series.values)?;
        let parts = cut
            .parts
            .iter()
            .filter(|part| part.values.len() >= LEAST)
            .map(|part| {
                let smooth = low_pass(&part.values, 1.0 / part.step_s, corner_hz);
                let knots: Vec<f64> = (0..smooth.len())
                    .map(|i| part.start_s + i as f64 * part.step_s)
                    .collect();
                (part.start_s, part.end_s(), Spline::natural(&knots, &smooth))
            });
        let parts: Vec<_> = parts.collect();
        (!parts.is_empty()).then_some(Signal {
            parts,
            rate_hz: 1.0 / cut.step_s,
        })
    }

    /// Value, first and second derivative; `None` in gaps and beyond the ends.
    pub fn at(&self, t: f64) -> Option<[f64; 3]> {
        let after = self.parts.partition_point(|(start, ..)| *start <= t);
        let (_, end, spline) = self.parts.get(after.checked_sub(1)?)?;
        (t <= *end).then(|| spline.at(t))
    }

    /// First and last time [s].
    pub fn span(&self) -> [f64; 2] {
        [self.parts[0].0, self.parts[self.parts.len() - 1].1]
    }
}
