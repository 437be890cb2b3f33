//! Hertz's closed form of smooth point contacts.

use crate::Error;
use crate::bisection::bisect;
use crate::problem::check::positive;

/// Elliptic point contact of two smooth elastic bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hertz {
    /// Semi-axis along the direction of the larger relative radius [m].
    pub a: f64,
    /// Semi-axis along the direction of the smaller relative radius [m].
    pub b: f64,
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Approach of points far from the contact [m].
    pub approach: f64,
}

/// Hertz contact for the undeformed gap x^2 / (2 `radius_x`) + y^2 / (2 `radius_y`).
///
/// With k = b/a, e^2 = 1 - k^2 and the complete elliptic integrals K(e) and E(e): radius_x /
/// radius_y = (E / k^2 - K) / (K - E); b^3 = 3 F k E / (pi E* (1/radius_x + 1/radius_y)); p_max = 3
/// F / (2 pi a b); approach = p_max b K / E* (K. L. Johnson, Contact Mechanics, 1985, eqs. 4.26 to
/// 4.28). `radius_x >= radius_y` [m], both positive; `contact_modulus` is E* with 1/E* = (1 -
/// nu1^2)/E1 + (1 - nu2^2)/E2 [Pa]; `force` [N].
///
/// ```
/// let ball = kufe_contact::hertz(0.01, 0.01, 9.0e9 / (1.0 - 0.33 * 0.33), 100.0)?;
/// assert!((ball.p_max / 2.702576e8 - 1.0).abs() < 1e-6);
/// assert!((ball.a - ball.b).abs() < 1e-9);
/// # Ok::<(), kufe_contact::Error>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] if a radius, the modulus or the force is not positive and finite, if
/// `radius_x < radius_y`, or if the radii are so far apart that a figure of the contact overflows.
pub fn hertz(
    radius_x: f64,
    radius_y: f64,
    contact_modulus: f64,
    force: f64,
) -> Result<Hertz, Error> {
    for (name, value) in [
        ("radius along x", radius_x),
        ("radius along y", radius_y),
        ("contact modulus", contact_modulus),
        ("normal force", force),
    ] {
        positive(name, value, "a positive number")?;
    }
    if radius_x < radius_y {
        let expected = "the larger of the two radii";
        return Err(Error::out_of_range("radius along x", radius_x, expected));
    }
    // The radii's ratio grows as k = b/a falls: bisect on ln k.
    let radii = radius_x / radius_y;
    let [low, high] = bisect([1e-9f64.ln(), 0.0], 200, |middle| {
        radius_ratio(middle.exp()) > radii
    });
    let k = (0.5 * (low + high)).exp();
    let (first, second) = elliptic_integrals(k);
    // The sum of Johnson's two curvature equations is (1/radius_x + 1/radius_y) / 2 = (p_max / E*)
    // E / b.
    let curvature = 0.5 * (1.0 / radius_x + 1.0 / radius_y);
    let b = (3.0 * force * k * second / (2.0 * std::f64::consts::PI * contact_modulus * curvature))
        .cbrt();
    let a = b / k;
    let p_max = 1.5 * force / (std::f64::consts::PI * a * b);
    let approach = p_max / contact_modulus * b * first;
    let found = Hertz {
        a,
        b,
        p_max,
        approach,
    };
    for (name, value) in [
        ("half-length of the patch", a),
        ("half-width of the patch", b),
        ("peak pressure", p_max),
        ("approach", approach),
    ] {
        let expected = "radii, a modulus and a force that are nearer to one another";
        positive(name, value, expected)?;
    }
    Ok(found)
}

/// R_x / R_y of an ellipse with b/a = `k`.
fn radius_ratio(k: f64) -> f64 {
    if (1.0 - k).abs() < 1e-7 {
        return 1.0 + 1.5 * (1.0 - k) * 2.0;
    }
    let (first, second) = elliptic_integrals(k);
    (second / (k * k) - first) / (first - second)
}

/// Complete elliptic integrals K(e) and E(e) with e^2 = 1 - k^2, by the arithmetic-geometric mean.
fn elliptic_integrals(k: f64) -> (f64, f64) {
    let (mut mean, mut geometric) = (1.0, k);
    let (mut sum, mut power) = (0.5 * (1.0 - k * k), 1.0);
    for _ in 0..40 {
        let half_difference = 0.5 * (mean - geometric);
        (mean, geometric) = (0.5 * (mean + geometric), (mean * geometric).sqrt());
        sum += power * half_difference * half_difference;
        power *= 2.0;
        if half_difference.abs() < 1e-17 * mean {
            break;
        }
    }
    let first = std::f64::consts::FRAC_PI_2 / mean;
    (first, first * (1.0 - sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGID: f64 = 9.0e9 / (1.0 - 0.33 * 0.33);

    #[test]
    fn hertz_reproduces_reference_rows_of_needle_shaped_patches() {
        // rocker, section, force, a, b, p_max, approach
        let rows = [
            [
                30.0,
                0.005,
                1000.0,
                2.513351e-02,
                1.371417e-04,
                1.385220e+08,
                1.240901e-05,
            ],
            [
                15.0,
                0.005,
                100.0,
                9.043795e-03,
                7.229439e-05,
                7.302744e+07,
                3.248989e-06,
            ],
            [
                150.0,
                0.005,
                4000.0,
                7.161599e-02,
                1.624929e-04,
                1.641183e+08,
                1.973656e-05,
            ],
            [
                5.0,
                0.0005,
                250.0,
                8.856100e-03,
                3.653015e-05,
                3.689669e+08,
                9.177503e-06,
            ],
        ];
        for [rx, ry, force, a, b, p, d] in rows {
            let h = hertz(rx, ry, RIGID, force).unwrap();
            for (value, expected) in [(h.a, a), (h.b, b), (h.p_max, p), (h.approach, d)] {
                assert!(
                    (value / expected - 1.0).abs() < 1e-6,
                    "{value} against {expected}"
                );
            }
        }
    }

    #[test]
    fn sphere_agrees_with_the_elementary_formula() {
        let h = hertz(0.01, 0.01, RIGID, 1000.0).unwrap();
        let a = (3.0 * 1000.0 * 0.01 / (4.0 * RIGID)).cbrt();
        assert!((h.a / a - 1.0).abs() < 1e-6);
        assert!((h.approach / (a * a / 0.01) - 1.0).abs() < 1e-6);
    }
}
