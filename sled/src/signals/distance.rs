//! Where the sled is at each state.

use std::ops::Range;

use crate::error::Error;
use crate::record::check::gaps::bridged;
use crate::record::run::Run;
use crate::signals::resampling::Resampling;

/// Where the sled is: as recorded, or from the speed.
pub(crate) enum Distance {
    Recorded(Vec<f64>),
    FromSpeed {
        /// Speed across gaps of it [m/s].
        bridged: Vec<f64>,
        /// The last state before the next stretch: its place in the recording, distance and speed.
        before: Option<(f64, f64, f64)>,
    },
}

impl Distance {
    pub(crate) fn of(run: &Run) -> Result<Distance, Error> {
        Ok(match run.columns.get("s_m") {
            Some(s) if run.gaps.within(s).flatten().all(|s| s.is_finite()) => {
                Distance::Recorded(s.clone())
            }
            _ => Distance::FromSpeed {
                bridged: bridged(run.column("v_mps")?),
                before: None,
            },
        })
    }

    /// Distances [m] of a stretch's states, `v` being their speeds.
    pub(crate) fn of_piece(
        &mut self,
        base: &Resampling,
        piece: &Range<usize>,
        v: &[f64],
    ) -> Vec<f64> {
        match self {
            Distance::Recorded(s) => base.resampled(s, piece),
            Distance::FromSpeed { bridged, before } => {
                let first = base.samples(piece).start as f64 * base.ratio;
                let start = match *before {
                    None => 0.0,
                    Some((from, s, v_from)) => {
                        s + across(bridged, (from, v_from), (first, v[0])) / base.from_hz
                    }
                };
                let mut distance = integrate(v, 1.0 / base.rate_hz);
                if start != 0.0 {
                    distance.iter_mut().for_each(|s| *s += start);
                }
                let last = v.len() - 1;
                *before = Some((first + last as f64 * base.ratio, distance[last], v[last]));
                distance
            }
        }
    }
}

/// Integral of the speed between two states, by the trapezoidal rule over the samples between; in samples times m/s.
fn across(v: &[f64], (from, v_from): (f64, f64), (to, v_to): (f64, f64)) -> f64 {
    let between = from.floor() as usize + 1..to.ceil() as usize;
    let inner = between.map(|i| (i as f64, v[i]));
    let points = std::iter::once((from, v_from))
        .chain(inner)
        .chain([(to, v_to)]);
    let mut sum = 0.0;
    let mut before = (from, v_from);
    for point in points {
        sum += 0.5 * (point.0 - before.0) * (point.1 + before.1);
        before = point;
    }
    sum
}

/// Distance from speed by the trapezoidal rule.
fn integrate(v: &[f64], dt: f64) -> Vec<f64> {
    let mut s = 0.0;
    let mut distance = vec![0.0; v.len()];
    for i in 1..v.len() {
        s += 0.5 * dt * (v[i - 1] + v[i]);
        distance[i] = s;
    }
    distance
}
