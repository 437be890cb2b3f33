//! Closed-form solutions that the elements are tested against.

use std::f64::consts::PI;

use crate::body::Material;

/// A straight beam of rectangular section, bending in the direction of its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Length L [m].
    pub length: f64,
    /// Width b of the section [m].
    pub width: f64,
    /// Height h of the section, along the load [m].
    pub height: f64,
    /// The material.
    pub material: Material,
}

impl Beam {
    /// Bending stiffness E I = E b h^3 / 12 [N m^2].
    pub fn bending_stiffness(&self) -> f64 {
        self.material.youngs_modulus() * self.width * self.height.powi(3) / 12.0
    }

    /// Shear stiffness kappa G b h [N], with kappa = 10 (1 + nu) / (12 + 11 nu).
    ///
    /// Source: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33
    /// (1966), 335-340.
    pub fn shear_stiffness(&self) -> f64 {
        let nu = self.material.poissons_ratio();
        let kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu);
        kappa * self.material.shear_modulus() * self.width * self.height
    }

    /// Deflection [m] of the free end of a cantilever under an end load F [N]: F L^3 / (3 E I) + F
    /// L / (kappa G A).
    ///
    /// Source: S. Timoshenko, Strength of Materials I (1955), article 39.
    pub fn cantilever_tip_deflection(&self, load: f64) -> f64 {
        load * self.length.powi(3) / (3.0 * self.bending_stiffness())
            + load * self.length / self.shear_stiffness()
    }
}

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

/// Stress in the half-space z <= 0 at `point` [m] under a downward point force at the origin.
///
/// Returns (xx, yy, zz, yz, zx, xy) [Pa], tension positive, `load` [N] positive downwards. With
/// depth d = -z:
///
/// ```text
/// s_xx = P/(2 pi) { -3 x^2 d/R^5 + (1-2nu) [ d/R^3 - 1/(R(R+d)) + x^2 (2R+d)/(R^3 (R+d)^2) ] },   s_yy likewise,
/// s_xy = P/(2 pi) x y { -3 d/R^5 + (1-2nu) (2R+d)/(R^3 (R+d)^2) },
/// s_zz = -3P/(2 pi) d^3/R^5,   s_zx = 3P/(2 pi) x d^2/R^5,   s_yz = 3P/(2 pi) y d^2/R^5.
/// ```
///
/// Source: K. L. Johnson, Contact Mechanics (1985), equations 3.19, written through R (R + d),
/// which stays finite on the axis. Singular at the origin.
pub fn boussinesq_stress(point: [f64; 3], load: f64, material: Material) -> [f64; 6] {
    let [x, y, z] = point;
    let d = -z;
    let r = (x * x + y * y + z * z).sqrt();
    let c = 1.0 - 2.0 * material.poissons_ratio();
    let scale = load / (2.0 * PI);
    let (r3, r5, s) = (r.powi(3), r.powi(5), r + d);
    let lateral = |a: f64| {
        -3.0 * a * a * d / r5 + c * (d / r3 - 1.0 / (r * s) + a * a * (2.0 * r + d) / (r3 * s * s))
    };
    [
        scale * lateral(x),
        scale * lateral(y),
        -3.0 * scale * d.powi(3) / r5,
        3.0 * scale * y * d * d / r5,
        3.0 * scale * x * d * d / r5,
        scale * x * y * (-3.0 * d / r5 + c * (2.0 * r + d) / (r3 * s * s)),
    ]
}

/// Depth to which a half-space sinks under a uniform pressure on a rectangle, times E / (1 - nu^2)
/// over the pressure [m]:
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

/// A thick-walled cylinder in plane strain under inner and outer pressure (Lame).
///
/// ```text
/// s_r = A - B / r^2,   s_t = A + B / r^2,   s_z = 2 nu A,
/// A = (p_i r_i^2 - p_o r_o^2) / (r_o^2 - r_i^2),   B = (p_i - p_o) r_i^2 r_o^2 / (r_o^2 - r_i^2),
/// u_r = (1 + nu) / E [ (1 - 2 nu) A r + B / r ].
/// ```
///
/// Source: S. Timoshenko and J. N. Goodier, Theory of Elasticity (1970), article 28.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThickCylinder {
    /// Inner radius r_i [m].
    pub inner_radius: f64,
    /// Outer radius r_o [m].
    pub outer_radius: f64,
    /// Pressure on the inner wall p_i [Pa].
    pub inner_pressure: f64,
    /// Pressure on the outer wall p_o [Pa].
    pub outer_pressure: f64,
}

impl ThickCylinder {
    fn constants(&self) -> (f64, f64) {
        let (i2, o2) = (self.inner_radius.powi(2), self.outer_radius.powi(2));
        (
            (self.inner_pressure * i2 - self.outer_pressure * o2) / (o2 - i2),
            (self.inner_pressure - self.outer_pressure) * i2 * o2 / (o2 - i2),
        )
    }

    /// Radial, hoop and axial stress [Pa] at radius `r` [m], tension positive.
    pub fn stress(&self, r: f64, material: Material) -> [f64; 3] {
        let (a, b) = self.constants();
        [
            a - b / (r * r),
            a + b / (r * r),
            2.0 * material.poissons_ratio() * a,
        ]
    }

    /// Radial displacement [m] at radius `r` [m].
    pub fn displacement(&self, r: f64, material: Material) -> f64 {
        let (a, b) = self.constants();
        let nu = material.poissons_ratio();
        (1.0 + nu) / material.youngs_modulus() * ((1.0 - 2.0 * nu) * a * r + b / r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steel() -> Beam {
        Beam {
            length: 0.6,
            width: 0.02,
            height: 0.008,
            material: Material::new(210e9, 0.3).unwrap(),
        }
    }

    #[test]
    fn slender_cantilevers_hardly_shear() {
        let beam = steel();
        let bending = 10.0 * 0.6f64.powi(3) / (3.0 * beam.bending_stiffness());
        let ratio = beam.cantilever_tip_deflection(10.0) / bending;
        // 3 E I / (kappa G A L^2) = E h^2 / (4 kappa G L^2) = 1.36e-4.
        assert!((ratio - 1.0 - 1.36e-4).abs() < 1e-6, "{ratio}");
    }

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

    fn differentiated_stress(p: [f64; 3], m: Material) -> [f64; 6] {
        let u = |q| boussinesq(q, 1.0, m);
        let g: [[f64; 3]; 3] = std::array::from_fn(|a| first(&u, p, a, 1e-3));
        m.stress([
            g[0][0],
            g[1][1],
            g[2][2],
            g[1][2] + g[2][1],
            g[0][2] + g[2][0],
            g[0][1] + g[1][0],
        ])
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

    #[test]
    fn stress_is_the_derivative_of_the_displacement_by_hookes_law() {
        for nu in [0.0, 0.33, 0.49] {
            let m = Material::new(9.0e9, nu).unwrap();
            for p in [[0.7, -0.4, -0.9], [0.0, 0.0, -0.6], [-1.1, 0.6, -0.3]] {
                let (exact, differences) =
                    (boussinesq_stress(p, 1.0, m), differentiated_stress(p, m));
                let size = exact.iter().fold(0.0f64, |s, v| s.max(v.abs()));
                for c in 0..6 {
                    assert!(
                        (exact[c] - differences[c]).abs() < 1e-8 * size,
                        "{nu} {p:?} {c}"
                    );
                }
            }
        }
    }

    #[test]
    fn surface_is_free_of_traction_away_from_the_point_load() {
        let m = ice();
        for p in [[0.5, 0.2, 0.0], [-1.0, 0.7, 0.0]] {
            let s = boussinesq_stress(p, 1.0, m);
            assert_eq!([s[2], s[3], s[4]], [0.0; 3]);
            // The same from the displacements, which continue smoothly past z = 0 away from the
            // origin.
            let d = differentiated_stress(p, m);
            for c in [2, 3, 4] {
                assert!(d[c].abs() < 1e-9 * s[0].abs().max(s[1].abs()), "{d:?}");
            }
        }
    }

    #[test]
    fn every_horizontal_plane_carries_the_whole_load() {
        // Integral of -s_zz over the plane at depth d with r = d tan t, midpoint rule in t.
        let n = 20_000;
        let depth = 0.7;
        let total: f64 = (0..n)
            .map(|i| {
                let t = (i as f64 + 0.5) / n as f64 * PI / 2.0;
                let r = depth * t.tan();
                let s = boussinesq_stress([r, 0.0, -depth], 5.0, ice());
                -s[2] * 2.0 * PI * r * depth / t.cos().powi(2) * (PI / 2.0 / n as f64)
            })
            .sum();
        assert!((total - 5.0).abs() < 1e-6, "{total}");
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

    #[test]
    fn walls_carry_their_pressures_and_the_inside_is_in_equilibrium() {
        let c = ThickCylinder {
            inner_radius: 1.0,
            outer_radius: 2.5,
            inner_pressure: 7.0,
            outer_pressure: 2.0,
        };
        let m = Material::new(100.0, 0.3).unwrap();
        assert!((c.stress(1.0, m)[0] + 7.0).abs() < 1e-14);
        assert!((c.stress(2.5, m)[0] + 2.0).abs() < 1e-14);
        let (r, h) = (1.7, 1e-4);
        let [radial, hoop, axial] = c.stress(r, m);
        let slope = (c.stress(r + h, m)[0] - c.stress(r - h, m)[0]) / (2.0 * h);
        assert!((slope + (radial - hoop) / r).abs() < 1e-6);
        // Hooke's law from the displacement: strains u', u / r, 0.
        let du = (c.displacement(r + h, m) - c.displacement(r - h, m)) / (2.0 * h);
        let stress = m.stress([du, c.displacement(r, m) / r, 0.0, 0.0, 0.0, 0.0]);
        for (found, expected) in stress.iter().zip([radial, hoop, axial]) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
}
