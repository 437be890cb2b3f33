//! The contact patch as a strip: width and mean pressure along the sliding direction.

use crate::friction::error::{Error, in_range};

/// A contact patch much longer than wide, by stations from its leading edge.
///
/// Between stations the pressure and the *square* of the width are linear: a round section that sinks in has `w^2 = 8 r D`, so that
/// the square grows evenly with depth and the rounded ends of a patch are met with few stations.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    xi: Vec<f64>,
    width: Vec<f64>,
    pressure: Vec<f64>,
}

impl Strip {
    /// A strip from stations `xi` [m], widths [m] and pressures averaged over the width [Pa], all of one length.
    ///
    /// # Errors
    /// [`Error::TooFew`] for fewer than two stations or columns of unequal length. [`Error::OutOfRange`] where the stations do not
    /// start at 0 and ascend, a width is negative or, between the ends, 0, a pressure is negative, no load is carried, or a number
    /// is not finite.
    pub fn new(xi: Vec<f64>, width: Vec<f64>, pressure: Vec<f64>) -> Result<Self, Error> {
        let n = xi.len();
        if n < 2 {
            return Err(too_few("stations of a strip", n, 2));
        }
        for (what, have) in [
            ("widths of a strip, one a station", width.len()),
            ("pressures of a strip, one a station", pressure.len()),
        ] {
            if have != n {
                return Err(too_few(what, have, n));
            }
        }
        in_range("xi", xi[0], xi[0] == 0.0, "0 at the leading edge")?;
        for pair in xi.windows(2) {
            in_range("xi", pair[1], pair[1] > pair[0], "stations that ascend")?;
        }
        for (k, &w) in width.iter().enumerate() {
            let end = k == 0 || k + 1 == n;
            let holds = if end { w >= 0.0 } else { w > 0.0 };
            in_range(
                "width",
                w,
                holds,
                "above 0 between the ends, 0 or more there",
            )?;
        }
        for &p in &pressure {
            in_range("pressure", p, p >= 0.0, "0 or more")?;
        }
        let strip = Strip {
            xi,
            width,
            pressure,
        };
        let carried: f64 = (0..n).map(|k| strip.width[k] * strip.pressure[k]).sum();
        in_range("pressure", carried, carried > 0.0, "a load that is carried")?;
        Ok(strip)
    }

    /// A rectangle of `length` [m] and `width` [m] under the `pressure` [Pa].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] as for [`Strip::new`].
    pub fn uniform(length: f64, width: f64, pressure: f64) -> Result<Self, Error> {
        Strip::new(vec![0.0, length], vec![width; 2], vec![pressure; 2])
    }

    /// Stations from the leading edge [m], the first 0.
    pub fn xi(&self) -> &[f64] {
        &self.xi
    }

    /// Widths at the stations [m].
    pub fn width(&self) -> &[f64] {
        &self.width
    }

    /// Pressures averaged over the width at the stations [Pa].
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Length from the leading to the trailing edge [m].
    pub fn length(&self) -> f64 {
        self.xi[self.xi.len() - 1]
    }

    /// Largest width [m].
    pub fn largest_width(&self) -> f64 {
        self.width.iter().copied().fold(0.0, f64::max)
    }

    /// Length over largest width.
    pub fn aspect(&self) -> f64 {
        self.length() / self.largest_width()
    }

    /// The strip on every second station, the last one kept; `None` below four stations.
    ///
    /// What it answers differently shows how far the stations resolve width and pressure.
    pub fn every_second(&self) -> Option<Self> {
        let n = self.xi.len();
        if n < 4 {
            return None;
        }
        let kept = |values: &[f64]| -> Vec<f64> {
            let mut kept: Vec<f64> = values[..n - 1].iter().copied().step_by(2).collect();
            kept.push(values[n - 1]);
            kept
        };
        Strip::new(kept(&self.xi), kept(&self.width), kept(&self.pressure)).ok()
    }
}

/// Linear between the values at the ends of segment `k` of `xi`.
pub(crate) fn between(xi: &[f64], values: &[f64], k: usize, at: f64) -> f64 {
    let share = (at - xi[k]) / (xi[k + 1] - xi[k]);
    values[k] + share * (values[k + 1] - values[k])
}

fn too_few(what: &str, have: usize, need: usize) -> Error {
    Error::TooFew {
        what: what.into(),
        have,
        need,
    }
}
