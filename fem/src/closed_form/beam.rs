//! Slender beams.

use crate::material::Material;

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
    /// Source: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33 (1966), 335-340.
    pub fn shear_stiffness(&self) -> f64 {
        let nu = self.material.poissons_ratio();
        let kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu);
        kappa * self.material.shear_modulus() * self.width * self.height
    }

    /// Deflection [m] of the free end of a cantilever under an end load F [N]: F L^3 / (3 E I) + F L / (kappa G A).
    ///
    /// Source: S. Timoshenko, Strength of Materials I (1955), article 39.
    pub fn cantilever_tip_deflection(&self, load: f64) -> f64 {
        load * self.length.powi(3) / (3.0 * self.bending_stiffness())
            + load * self.length / self.shear_stiffness()
    }

    /// Deflection [m] of an infinite beam on an elastic foundation at the distance `x` [m] from a point load F [N].
    ///
    /// With the foundation's force per length and deflection k [N/m^2] and beta = (k / (4 E I))^(1/4):
    /// w = F beta / (2 k) exp(-beta |x|) (cos beta |x| + sin beta |x|). Without shear deformation; the beam's own length is
    /// not used. Source: M. Hetenyi, Beams on Elastic Foundation (1946), chapter 2.
    pub fn deflection_on_foundation(&self, x: f64, load: f64, foundation: f64) -> f64 {
        let beta = (foundation / (4.0 * self.bending_stiffness())).powf(0.25);
        let s = beta * x.abs();
        load * beta / (2.0 * foundation) * (-s).exp() * (s.cos() + s.sin())
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
    fn foundation_carries_the_load_and_the_beam_bends_by_its_differential_equation() {
        let (beam, k, load) = (steel(), 5.0e8, 1000.0);
        let w = |x: f64| beam.deflection_on_foundation(x, load, k);
        let (n, reach) = (200_000, 2.0);
        let dx = reach / n as f64;
        let carried: f64 = (0..n)
            .map(|i| 2.0 * k * w((i as f64 + 0.5) * dx) * dx)
            .sum();
        assert!((carried / load - 1.0).abs() < 1e-8, "{carried}");
        // E I w'''' + k w = 0 beside the load, by central differences.
        let (x, h) = (0.03, 1e-3);
        let fourth = (w(x - 2.0 * h) - 4.0 * w(x - h) + 6.0 * w(x) - 4.0 * w(x + h)
            + w(x + 2.0 * h))
            / h.powi(4);
        let residual = beam.bending_stiffness() * fourth + k * w(x);
        assert!(
            residual.abs() < 1e-3 * k * w(0.0),
            "{residual} {}",
            k * w(0.0)
        );
    }

    #[test]
    fn slender_cantilevers_hardly_shear() {
        let beam = steel();
        let bending = 10.0 * 0.6f64.powi(3) / (3.0 * beam.bending_stiffness());
        let ratio = beam.cantilever_tip_deflection(10.0) / bending;
        // 3 E I / (kappa G A L^2) = E h^2 / (4 kappa G L^2) = 1.36e-4.
        assert!((ratio - 1.0 - 1.36e-4).abs() < 1e-6, "{ratio}");
    }
}
