//! A long thick-walled cylinder under pressure.

use crate::material::Material;

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
