//! Reduced curvatures: curvatures relative to the curvature at which the runner lies flush on the
//! track.

use std::hint::select_unpredictable;

use serde::{Deserialize, Serialize};

use crate::error::Error;

/// Scaling of the curvature by the flush curvature of a runner of finite length, and by the load.
///
/// On a track with the curvature of the rocker the contact extends from end to end. As a function
/// of the curvature the peak pressure has a V-shaped minimum there, over a width that grows with
/// the load: a rigid runner of half-length L on a half-space of contact modulus E* depends on the
/// curvature mostly through `(kappa - flush) E* L^3 / Fz`. A table over the reduced curvature
///
/// ```text
/// t = (s(kappa) - s(from)) / (s(to) - s(from)),   s(kappa) = asinh((kappa - flush) / (scale Fz))
/// ```
///
/// has the minimum at nearly the same coordinate for all loads, resolves it, and covers the whole
/// range of curvatures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "FlushKeys")]
pub struct CurvatureScaling {
    #[serde(rename = "curvature_1pm")]
    curvature: f64,
    #[serde(rename = "scale_1pm_per_n")]
    scale: f64,
    #[serde(rename = "from_1pm")]
    from: f64,
    #[serde(rename = "to_1pm")]
    to: f64,
}

/// The parameters in a file, before checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FlushKeys {
    curvature_1pm: f64,
    scale_1pm_per_n: f64,
    from_1pm: f64,
    to_1pm: f64,
}

impl TryFrom<FlushKeys> for CurvatureScaling {
    type Error = Error;

    fn try_from(keys: FlushKeys) -> Result<Self, Error> {
        let ends = [keys.from_1pm, keys.to_1pm];
        CurvatureScaling::new(keys.curvature_1pm, keys.scale_1pm_per_n, ends)
    }
}

impl CurvatureScaling {
    /// The flush `curvature` [1/m], its `scale` [1/(m N)] (about `10 / (E* L^3)`), and the
    /// curvatures `from` and `to` [1/m] of the reduced curvatures 0 and 1.
    ///
    /// # Errors
    /// [`Error::Invalid`] where a number is not finite, the scale not positive, or the order not
    /// `from < curvature < to`.
    pub fn new(curvature: f64, scale: f64, [from, to]: [f64; 2]) -> Result<Self, Error> {
        let wrong = |key: &str, value: f64, expected: &str| {
            Error::Invalid(format!("flush.{key} = {value}: expected {expected}"))
        };
        for (key, value) in [
            ("curvature_1pm", curvature),
            ("from_1pm", from),
            ("to_1pm", to),
        ] {
            if !value.is_finite() {
                return Err(wrong(key, value, "a finite number"));
            }
        }
        if !(1e-15..=1.0).contains(&scale) {
            return Err(wrong("scale_1pm_per_n", scale, "between 1e-15 and 1"));
        }
        if !(from < curvature && curvature < to) {
            let expected = "a curvature between the ends of its axis";
            return Err(wrong("curvature_1pm", curvature, expected));
        }
        Ok(CurvatureScaling {
            curvature,
            scale,
            from,
            to,
        })
    }

    /// The flush curvature, the scale, and the curvatures at 0 and 1, in the order of
    /// [`CurvatureScaling::new`].
    pub fn numbers(&self) -> [f64; 4] {
        [self.curvature, self.scale, self.from, self.to]
    }

    /// The reduced curvature of a force [N] and a curvature [1/m]: 0 and 1 at the ends, below 0 or
    /// above 1 outside.
    #[inline]
    pub fn reduced(&self, fz: f64, curvature: f64) -> f64 {
        // Differences of asinh as one logarithm each; the arithmetic of kufe_lut_place_on_ in
        // c/kufe_lut.h.
        let far = |x: f64| x.abs() + (1.0 + x * x).sqrt();
        let width = self.scale * fz;
        let below = far((self.from - self.curvature) / width);
        let whole = (far((self.to - self.curvature) / width) * below).ln();
        let x = (curvature - self.curvature) / width;
        // Without a branch: random inputs would mispredict it.
        let near = far(x);
        let part = select_unpredictable(x < 0.0, below / near, near * below);
        part.ln() / whole
    }

    /// The curvature [1/m] of a force [N] and a reduced curvature.
    pub fn curvature(&self, fz: f64, reduced: f64) -> f64 {
        // The ends are reproduced exactly.
        if reduced == 0.0 {
            return self.from;
        }
        if reduced == 1.0 {
            return self.to;
        }
        let width = self.scale * fz;
        let [from, to] = [self.from, self.to].map(|end| ((end - self.curvature) / width).asinh());
        self.curvature + width * (from + reduced * (to - from)).sinh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reducing_and_back_gives_the_curvature_and_the_ends_exactly() -> Result<(), Error> {
        let flush = CurvatureScaling::new(1.0 / 30.0, 1e-8, [-0.02, 1.0 / 12.0])?;
        for fz in [200.0, 1265.0, 8000.0] {
            assert_eq!(flush.reduced(fz, -0.02), 0.0);
            assert_eq!(flush.reduced(fz, 1.0 / 12.0), 1.0);
            assert!(flush.reduced(fz, -0.03) < 0.0 && flush.reduced(fz, 0.1) > 1.0);
            let mut before = -1.0;
            for i in 0..=1000 {
                let curvature = -0.02 + (1.0 / 12.0 + 0.02) * f64::from(i) / 1000.0;
                let reduced = flush.reduced(fz, curvature);
                assert!(reduced > before);
                assert!((flush.curvature(fz, reduced) - curvature).abs() < 1e-14);
                before = reduced;
            }
        }
        Ok(())
    }
}
