//! Closed-form solutions, the references of the element tests.

use std::f64::consts::PI;

use kufe_fem::Material;

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
