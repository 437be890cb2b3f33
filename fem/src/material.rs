//! Isotropic linear elastic materials.

use crate::error::Error;

/// An isotropic linear elastic material.
///
/// ```
/// let ice = kufe_fem::Material::new(9.0e9, 0.33)?;
/// assert!((ice.plane_strain_modulus() - 10.1e9).abs() < 1e7);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    youngs_modulus: f64,
    poissons_ratio: f64,
}

impl Material {
    /// A material from Young's modulus E [Pa] and Poisson's ratio nu.
    ///
    /// Fails unless 0 < E < infinity and -1 < nu < 0.5.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self, Error> {
        if !(youngs_modulus > 0.0 && youngs_modulus.is_finite()) {
            return Err(Error::YoungsModulus {
                found: youngs_modulus,
            });
        }
        if !(poissons_ratio > -1.0 && poissons_ratio < 0.5) {
            return Err(Error::PoissonsRatio {
                found: poissons_ratio,
            });
        }
        Ok(Self {
            youngs_modulus,
            poissons_ratio,
        })
    }

    /// Young's modulus E [Pa].
    pub fn youngs_modulus(&self) -> f64 {
        self.youngs_modulus
    }

    /// Poisson's ratio nu.
    pub fn poissons_ratio(&self) -> f64 {
        self.poissons_ratio
    }

    /// Shear modulus, Lame's second constant: mu = E / (2 (1 + nu)) [Pa].
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
    }

    /// Lame's first constant: lambda = E nu / ((1 + nu) (1 - 2 nu)) [Pa].
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poissons_ratio;
        self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Plane-strain modulus: E' = E / (1 - nu^2) [Pa], the half-space's modulus in contact.
    pub fn plane_strain_modulus(&self) -> f64 {
        self.youngs_modulus / (1.0 - self.poissons_ratio * self.poissons_ratio)
    }

    /// Modulus of uniaxial strain: M = lambda + 2 mu [Pa].
    pub fn uniaxial_strain_modulus(&self) -> f64 {
        self.lame_lambda() + 2.0 * self.shear_modulus()
    }

    /// Stress [Pa] of a small strain, both as (xx, yy, zz, yz, zx, xy) with engineering shear strains.
    ///
    /// sigma = lambda tr(epsilon) I + 2 mu epsilon.
    pub fn stress(&self, strain: [f64; 6]) -> [f64; 6] {
        let mu = self.shear_modulus();
        let pressure = self.lame_lambda() * (strain[0] + strain[1] + strain[2]);
        [
            pressure + 2.0 * mu * strain[0],
            pressure + 2.0 * mu * strain[1],
            pressure + 2.0 * mu * strain[2],
            mu * strain[3],
            mu * strain[4],
            mu * strain[5],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moduli_that_no_solid_has_are_refused_with_the_value() {
        for e in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = Material::new(e, 0.3).unwrap_err();
            assert!(error.to_string().contains(&format!("{e}")), "{error}");
        }
        for nu in [0.5, 0.7, -1.0, f64::NAN, f64::INFINITY] {
            let error = Material::new(1.0, nu).unwrap_err();
            assert!(matches!(error, Error::PoissonsRatio { .. }), "{error}");
        }
    }

    #[test]
    fn uniaxial_stress_gives_youngs_modulus_and_poissons_ratio() {
        let steel = Material::new(210e9, 0.3).unwrap();
        let stress = steel.stress([1e-3, -0.3e-3, -0.3e-3, 0.0, 0.0, 0.0]);
        assert!((stress[0] - 210e6).abs() < 1e-6);
        assert!(stress[1].abs() < 1e-6 && stress[2].abs() < 1e-6);
        assert!((steel.uniaxial_strain_modulus() - 2.826923e11).abs() < 1e6);
    }
}
