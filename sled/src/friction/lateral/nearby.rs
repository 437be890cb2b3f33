//! Sines, cosines and arctangents from those of an argument close by: series of the difference, exact to the rounding of what is known.

/// Largest difference of which the series are used; the first term left out is 4e-18 of the whole.
const NEAR: f64 = 0.05;

/// Sine and cosine of an angle [rad] from those of another, `from`; asked anew where the two are far apart.
///
/// ```
/// let known = 0.3_f64.sin_cos();
/// let (sine, cosine) = kufe_sled::friction::sin_cos_near(0.31, 0.3, known);
/// assert!((sine - 0.31_f64.sin()).abs() < 2e-16 && (cosine - 0.31_f64.cos()).abs() < 2e-16);
/// ```
#[inline]
pub fn sin_cos_near(angle: f64, from: f64, (sine, cosine): (f64, f64)) -> (f64, f64) {
    let d = angle - from;
    if d == 0.0 {
        return (sine, cosine);
    }
    if d.abs() > NEAR || d.is_nan() {
        return angle.sin_cos();
    }
    let q = d * d;
    let s = d
        * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q * (1.0 / 362_880.0)))));
    // 1 - cos(d), so that what is known keeps its digits.
    let c = q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40320.0))));
    (
        sine + (cosine * s - sine * c),
        cosine - (sine * s + cosine * c),
    )
}

/// The arctangent of `x` [rad] from that of another of the same sign, `from`; asked anew where the two are far apart.
#[inline]
pub fn atan_near(x: f64, from: f64, of_from: f64) -> f64 {
    let d = (x - from) / (1.0 + x * from);
    if d.is_nan() || d.abs() > NEAR || x * from < 0.0 {
        return x.atan();
    }
    let q = d * d;
    let rest =
        q * (1.0 / 5.0 - q * (1.0 / 7.0 - q * (1.0 / 9.0 - q * (1.0 / 11.0 - q * (1.0 / 13.0)))));
    of_from + d * (1.0 - q * (1.0 / 3.0 - rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_close_by_is_that_of_the_library_to_rounding() {
        for k in 0..2000 {
            let from = (f64::from(k) * 0.7311).sin() * 6.0;
            for d in [0.0, 1e-9, -1e-4, 3e-3, -0.049, 0.0499, 0.2] {
                let to = from + d;
                let (sine, cosine) = sin_cos_near(to, from, from.sin_cos());
                assert!((sine - to.sin()).abs() < 3e-16, "sin {to} from {from}");
                assert!((cosine - to.cos()).abs() < 3e-16, "cos {to} from {from}");
                let (to, from) = (to.exp2(), from.exp2());
                let of_x = atan_near(to, from, from.atan());
                assert!(
                    (of_x - to.atan()).abs() < 4e-16 * to.atan(),
                    "atan {to} from {from}"
                );
            }
        }
        assert!(sin_cos_near(f64::NAN, 0.0, (0.0, 1.0)).0.is_nan());
        assert!(atan_near(f64::NAN, 1.0, 1.0_f64.atan()).is_nan());
        assert_eq!(
            atan_near(f64::INFINITY, 1.0, 1.0_f64.atan()),
            std::f64::consts::FRAC_PI_2
        );
    }
}
