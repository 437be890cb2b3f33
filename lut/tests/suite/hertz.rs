//! Hertz's elliptic contact in closed form, the truth that tables are tested with.

use kufe_lut::{Figures, Point, Quantity};

/// Contact of a rigid paraboloid with ice (E = 9 GPa, nu = 0.33), rocker radius and section radius
/// given.
///
/// With the curvatures `A = 1/(2 R1) < B = 1/(2 R2)`, ratio `k = b/a`, `e^2 = 1 - k^2`:
/// `B/A = (E(e)/k^2 - K(e)) / (K(e) - E(e))` gives `k`; `a^3 = 3 F E(e) / (2 pi k^2 E* (A + B))`,
/// `p = 3 F / (2 pi a b)`, approach `= 3 F K(e) / (2 pi a E*)`. K. L. Johnson, Contact Mechanics
/// (1985), section 4.2.
pub fn hertz(fz: f64, rocker: f64, section: f64) -> Figures {
    let e_star = 9e9 / (1.0 - 0.33f64 * 0.33);
    let (a_curvature, b_curvature) = (0.5 / rocker, 0.5 / section);
    let ratio = |k: f64| {
        let (first, second) = complete_elliptic(k);
        (second / (k * k) - first) / (first - second)
    };
    let (mut low, mut high) = (1e-7f64, 1.0 - 1e-9);
    for _ in 0..200 {
        let middle = (low * high).sqrt();
        if ratio(middle) > b_curvature / a_curvature {
            low = middle;
        } else {
            high = middle;
        }
    }
    let k = (low * high).sqrt();
    let (first, second) = complete_elliptic(k);
    let pi = std::f64::consts::PI;
    let a = (3.0 * fz * second / (2.0 * pi * k * k * e_star * (a_curvature + b_curvature))).cbrt();
    let b = k * a;
    let area = pi * a * b;
    let approach = 3.0 * fz * first / (2.0 * pi * a * e_star);
    Figures::at_rest([1.5 * fz / area, fz / area, area, 2.0 * a, 2.0 * b, approach])
        .with_error(Quantity::PMax, 0.0)
}

/// `K(e)` and `E(e)` for the complementary modulus `k`, by the arithmetic-geometric mean.
fn complete_elliptic(k: f64) -> (f64, f64) {
    let (mut a, mut g, mut c2) = (1.0, k, 1.0 - k * k);
    let (mut sum, mut power) = (0.5 * c2, 0.5);
    for _ in 0..40 {
        let mean = 0.5 * (a + g);
        c2 = (0.5 * (a - g)).powi(2);
        power *= 2.0;
        sum += power * c2;
        g = (a * g).sqrt();
        a = mean;
        if c2 < 1e-34 {
            break;
        }
    }
    let first = std::f64::consts::FRAC_PI_2 / a;
    (first, first * (1.0 - sum))
}

/// The bobsled runner of section radius 5 mm whose rocker of 30 m runs on a curved track:
/// `1/R = 1/30 - curvature`.
pub fn runner(point: &Point) -> Figures {
    let rocker = point.rocker_radius.unwrap_or(30.0);
    hertz(point.fz, 1.0 / (1.0 / rocker - point.curvature), 0.005)
}
