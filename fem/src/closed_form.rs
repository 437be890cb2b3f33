//! Closed-form solutions of the half-space.

use std::f64::consts::PI;

use crate::body::Material;

/// Displacement of the half-space z <= 0 at `point` [m] under a downward point force at the origin.
///
/// With depth d = -z, distance R = |point|, shear modulus mu and force P (positive downwards):
///
/// ```text
/// u_x = P x / (4 pi mu) [ d / R^3 - (1 - 2 nu) / (R (R + d)) ],   u_y likewise,
/// u_z = -P / (4 pi mu) [ d^2 / R^3 + 2 (1 - nu) / R ].
/// ```
///
/// Returns (u_x, u_y, u_z) [m] for `load` in [N]. Infinite at the origin itself, where the solution
/// is singular. Source: K. L. Johnson, Contact Mechanics (1985), equations 3.18.
///
/// ```
/// let ice = kufe_fem::Material::new(9.0e9, 0.33)?;
/// let u = kufe_fem::boussinesq([0.01, 0.0, 0.0], 1000.0, ice);
/// assert!((u[2] + 1000.0 / (std::f64::consts::PI * ice.plane_strain_modulus() * 0.01)).abs() < 1e-18);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
pub fn boussinesq(point: [f64; 3], load: f64, material: Material) -> [f64; 3] {
    let [x, y, z] = point;
    let depth = -z;
    let r = (x * x + y * y + z * z).sqrt();
    let nu = material.poissons_ratio();
    let scale = load / (4.0 * PI * material.shear_modulus());
    if r == 0.0 {
        return [0.0, 0.0, -load * f64::INFINITY];
    }
    let radial = depth / (r * r * r) - (1.0 - 2.0 * nu) / (r * (r + depth));
    [
        scale * x * radial,
        scale * y * radial,
        -scale * (depth * depth / (r * r * r) + 2.0 * (1.0 - nu) / r),
    ]
}

/// Downward displacement of a half-space under a uniform pressure on a rectangle, times E / (1 -
/// nu^2) and divided by the pressure [m]:
///
/// ```text
/// d = [ F(x+a, y+b) - F(x+a, y-b) - F(x-a, y+b) + F(x-a, y-b) ] / pi,
/// F(x, y) = x asinh(y / |x|) + y asinh(x / |y|).
/// ```
///
/// The rectangle spans |x| <= a, |y| <= b, `half_widths` = [a, b] [m]; `point` is (x, y) [m],
/// inside or outside of it. Source: A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929); K. L.
/// Johnson, Contact Mechanics (1985), equation 3.25.
pub fn love_depth(point: [f64; 2], half_widths: [f64; 2]) -> f64 {
    fn term(x: f64, y: f64) -> f64 {
        if x == 0.0 {
            0.0
        } else {
            x * (y / x.abs()).asinh()
        }
    }
    let corner = |x: f64, y: f64| term(x, y) + term(y, x);
    let ([x, y], [a, b]) = (point, half_widths);
    let sum =
        corner(x + a, y + b) - corner(x + a, y - b) - corner(x - a, y + b) + corner(x - a, y - b);
    sum / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ice() -> Material {
        Material::new(9.0e9, 0.33).unwrap()
    }

    /// Second derivative d2 u / (d x_a d x_b) by central differences of fourth order along one axis
    /// at a time.
    fn second(
        u: &dyn Fn([f64; 3]) -> [f64; 3],
        p: [f64; 3],
        a: usize,
        b: usize,
        h: f64,
    ) -> [f64; 3] {
        first(&|q| first(u, q, b, h), p, a, h)
    }

    fn first(u: &dyn Fn([f64; 3]) -> [f64; 3], p: [f64; 3], a: usize, h: f64) -> [f64; 3] {
        let at = |s: f64| {
            let mut q = p;
            q[a] += s * h;
            u(q)
        };
        let (m2, m1, p1, p2) = (at(-2.0), at(-1.0), at(1.0), at(2.0));
        std::array::from_fn(|c| (m2[c] - 8.0 * m1[c] + 8.0 * p1[c] - p2[c]) / (12.0 * h))
    }

    #[test]
    fn point_load_satisfies_naviers_equation_inside() {
        let m = ice();
        let (lambda, mu) = (m.lame_lambda(), m.shear_modulus());
        let u = |q| boussinesq(q, 1.0, m);
        for p in [[0.7, -0.4, -0.9], [0.3, 0.2, -0.5], [-1.1, 0.6, -0.3]] {
            let d: Vec<Vec<[f64; 3]>> = (0..3)
                .map(|a| (0..3).map(|b| second(&u, p, a, b, 4e-3)).collect())
                .collect();
            for c in 0..3 {
                let grad_div: f64 = (0..3).map(|k| d[c][k][k]).sum();
                let laplacian: f64 = (0..3).map(|k| d[k][k][c]).sum();
                let residual = (lambda + mu) * grad_div + mu * laplacian;
                let size = mu * (0..3).map(|k| d[k][k][c].abs()).sum::<f64>();
                // Fourth-order differences at h = 4e-3 of a field that varies over about 0.5.
                assert!(residual.abs() < 1e-5 * size, "{p:?} {c}: {residual} {size}");
            }
        }
    }

    fn love_rectangle(point: [f64; 2], half_widths: [f64; 2], pressure: f64, m: Material) -> f64 {
        -pressure / m.plane_strain_modulus() * love_depth(point, half_widths)
    }

    #[test]
    fn rectangle_of_pressure_is_the_integral_of_point_loads() {
        let m = ice();
        let (a, b, p) = (0.02, 0.005, 1.0e6);
        for at in [[0.05, 0.01], [0.0, 0.02], [-0.03, -0.03]] {
            let (nx, ny) = (400, 100);
            let (dx, dy) = (2.0 * a / nx as f64, 2.0 * b / ny as f64);
            let mut sum = 0.0;
            for i in 0..nx {
                for j in 0..ny {
                    let x = -a + (i as f64 + 0.5) * dx;
                    let y = -b + (j as f64 + 0.5) * dy;
                    sum += boussinesq([at[0] - x, at[1] - y, 0.0], p * dx * dy, m)[2];
                }
            }
            let exact = love_rectangle(at, [a, b], p, m);
            assert!((sum - exact).abs() < 1e-4 * exact.abs(), "{sum} {exact}");
        }
    }

    #[test]
    fn square_sinks_at_its_corner_by_half_of_its_centre() {
        let m = ice();
        let centre = love_rectangle([0.0, 0.0], [1.0, 1.0], 1.0, m);
        let corner = love_rectangle([1.0, 1.0], [1.0, 1.0], 1.0, m);
        assert!((corner / centre - 0.5).abs() < 1e-14);
        // Timoshenko and Goodier: centre of a square of half width a sinks 2.24 p a (1 - nu^2) / E.
        let expected = -8.0 / PI * 1.0f64.asinh() / m.plane_strain_modulus();
        assert!((centre / expected - 1.0).abs() < 1e-14);
    }
}
