//! A sensor at its end stop.

use serde::Serialize;

/// Samples of one value at the channel's end from which a sensor is said to stand at its stop: what moves and is measured with noise
/// stays within a converter's step for two or three.
const STRETCH: usize = 8;

/// What a channel shows of its end stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Saturation {
    /// The stop, in the channel's unit: the one at which the channel stays longest.
    pub at: f64,
    /// Samples at it in stretches of eight or more.
    pub samples: usize,
    /// The longest of these stretches, in samples.
    pub longest: usize,
    /// The sample at which that begins.
    pub begins: usize,
}

impl Saturation {
    /// Stretches of equal samples at the largest or the smallest value of a channel; none where it has only one value.
    ///
    /// The end that is nearer to zero counts only where most values differ from those before: a channel that rests there rests.
    pub fn of(values: &[f64]) -> Option<Saturation> {
        let known = || values.iter().copied().filter(|x| x.is_finite());
        let low = known().fold(f64::INFINITY, f64::min);
        let high = known().fold(f64::NEG_INFINITY, f64::max);
        if known().all(|x| x.abs() == known().next().unwrap_or(0.0).abs()) {
            return None;
        }
        let moving = values.windows(2).filter(|w| w[0] != w[1]).count();
        let rests = 2 * moving < values.len();
        let far = low.abs().max(high.abs());
        let ends = [low, high].into_iter();
        ends.filter(|end| end.abs() == far || !rests)
            .filter_map(|end| at_end(values, end))
            .max_by_key(|found| found.longest)
    }

    /// In words, of a channel whose first sample is at `t0_s`.
    pub fn told(&self, column: &str, t0_s: f64, dt_s: f64) -> String {
        format!(
            "column {column} stays at its extreme {} for {} samples from t = {:.3} s on: saturated?",
            self.at,
            self.longest,
            t0_s + self.begins as f64 * dt_s
        )
    }
}

fn at_end(values: &[f64], end: f64) -> Option<Saturation> {
    let mut found = Saturation {
        at: end,
        samples: 0,
        longest: 0,
        begins: 0,
    };
    let mut i = 0;
    while i < values.len() {
        let length = values[i..].iter().take_while(|x| **x == end).count();
        if length >= STRETCH {
            found.samples += length;
            if length > found.longest {
                (found.longest, found.begins) = (length, i);
            }
        }
        i += length.max(1);
    }
    (found.samples > 0).then_some(found)
}
