//! The ice: elastic constants, hardness and foundation.

use kufe_fem::ElementKind;

/// The ice under the runner.
#[derive(Clone, Debug, PartialEq)]
pub struct Ice {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// What the ice rests on.
    pub foundation: Foundation,
    /// Hardness: largest pressure of the surface [Pa]; `None` for elastic ice.
    pub hardness: Option<f64>,
}

impl Ice {
    /// An elastic half-space of a Young's modulus [Pa] and a Poisson's ratio.
    pub fn half_space(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        Ice {
            youngs_modulus,
            poissons_ratio,
            foundation: Foundation::HalfSpace,
            hardness: None,
        }
    }

    /// Compliance as a half-space, (1 - nu^2) / E [1/Pa].
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus
    }

    /// Element of its hexahedra and of those of its bed.
    pub fn element_kind(&self) -> ElementKind {
        let ratio = match self.foundation {
            Foundation::ElasticBed { bed, .. } => self.poissons_ratio.max(bed.poissons_ratio),
            Foundation::HalfSpace | Foundation::RigidBed { .. } => self.poissons_ratio,
        };
        ElementKind::of_block(ratio)
    }
}

/// Foundation of the ice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Foundation {
    /// Unbounded ice: the far field is that of a half-space.
    HalfSpace,
    /// A layer bonded to a rigid bed.
    RigidBed {
        /// Thickness of the layer [m].
        thickness: f64,
    },
    /// A layer bonded to an elastic one, which is bonded to a rigid bed: ice on the concrete of a
    /// track.
    ElasticBed {
        /// Thickness of the ice [m].
        thickness: f64,
        /// The elastic layer under the ice.
        bed: Bed,
    },
}

/// An elastic layer under the ice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bed {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Thickness [m].
    pub thickness: f64,
}

// Properties of ice as functions of temperature.

/// Poisson's ratio of polycrystalline ice (P. H. Gammon, H. Kiefte, M. J. Clouter and W. W. Denner,
/// J. Glaciol. 29 (1983) 433-460, doi 10.1017/s0022143000030355). All elastic constants change with
/// temperature by the same factor, so the ratio does not.
pub const ICE_POISSONS_RATIO: f64 = 0.325;

/// Young's modulus of polycrystalline ice at `temperature` [C], in [Pa].
///
/// E = 9.33 GPa (1 - 1.42e-3 (T + 16)): the isotropic average of the single crystal's constants,
/// measured by Brillouin spectroscopy at -16 C, and their common change with temperature (Gammon,
/// Kiefte, Clouter and Denner 1983, doi 10.1017/s0022143000030355). It is the modulus of fast
/// loading, without creep.
///
/// ```
/// assert!((kufe_contact::ice_youngs_modulus(-5.0) / 9.18e9 - 1.0).abs() < 1e-3);
/// ```
pub fn ice_youngs_modulus(temperature: f64) -> f64 {
    9.33e9 * (1.0 - 1.42e-3 * (temperature + 16.0))
}

/// Indentation hardness of the ice of bobsled tracks and speed-skating ovals at `temperature` [C],
/// in [Pa].
///
/// H = (14.7 - 0.6 T) MPa, from balls dropped on such ice (L. Poirier, E. P. Lozowski and R. I.
/// Thompson, Ice hardness in winter sports, Cold Reg. Sci. Technol. 67 (2011) 129-134). Their
/// constants are uncertain by 2.1 MPa and 0.4 MPa/K. That paper is behind a paywall; J. H. Lever
/// and others, J. Glaciol. 68 (2022) 337-356, doi 10.1017/jog.2021.97, which is open, quotes 17.4
/// MPa at -4.5 C and 17.7 MPa at -5 C from the same group (by a summary of it), and the line
/// passes through both.
///
/// ```
/// assert!((kufe_contact::ice_hardness(-5.0) / 17.7e6 - 1.0).abs() < 1e-12);
/// ```
pub fn ice_hardness(temperature: f64) -> f64 {
    14.7e6 - 0.6e6 * temperature
}

/// Pressure that melts ice of `temperature` [C], in [Pa].
///
/// p = -T/(0.074 K/MPa): 13.5 MPa a kelvin below 0 C (V. F. Petrenko and R. W. Whitworth, Physics
/// of Ice, Oxford 1999).
///
/// ```
/// assert!((kufe_contact::ice_melting_pressure(-1.0) / 13.5e6 - 1.0).abs() < 2e-3);
/// ```
pub fn ice_melting_pressure(temperature: f64) -> f64 {
    (-temperature / 7.4e-8).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Young's modulus and Poisson's ratio of an isotropic polycrystal from the five constants of
    /// hexagonal crystals, c11, c12, c13, c33, c44: the mean of Voigt's and Reuss's averages (R.
    /// Hill, Proc. Phys. Soc. A 65 (1952) 349).
    fn polycrystal([c11, c12, c13, c33, c44]: [f64; 5]) -> [f64; 2] {
        let c66 = 0.5 * (c11 - c12);
        let bulk_voigt = (2.0 * (c11 + c12) + 4.0 * c13 + c33) / 9.0;
        let shear_voigt = (c11 + c12 + 2.0 * c33 - 4.0 * c13 + 12.0 * (c44 + c66)) / 30.0;
        let c2 = (c11 + c12) * c33 - 2.0 * c13 * c13;
        let bulk_reuss = c2 / (c11 + c12 + 2.0 * c33 - 4.0 * c13);
        let shear_reuss = 2.5 * c2 * c44 * c66 / (3.0 * bulk_voigt * c44 * c66 + c2 * (c44 + c66));
        let (k, g) = (
            0.5 * (bulk_voigt + bulk_reuss),
            0.5 * (shear_voigt + shear_reuss),
        );
        [
            9.0 * k * g / (3.0 * k + g),
            (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g),
        ]
    }

    /// The single crystal's constants are in the abstracts of the paper, at -16 C, and of an
    /// earlier one by three of its authors, at -3 C (J. Glaciol. 25 (1980) 159-167).
    #[test]
    fn the_modulus_is_within_two_per_cent_of_a_polycrystal_of_the_measured_crystals() {
        let cold = [13.929e9, 7.082e9, 5.765e9, 15.010e9, 3.014e9];
        let warm = [13.696e9, 6.966e9, 5.628e9, 14.702e9, 2.959e9];
        for (crystal, temperature) in [(cold, -16.0), (warm, -3.0)] {
            let [modulus, ratio] = polycrystal(crystal);
            // Hill's mean lies 1.4 % below the paper's own average.
            assert!(
                (ice_youngs_modulus(temperature) / modulus - 1.0).abs() < 0.016,
                "{modulus:.4e}"
            );
            assert!((ICE_POISSONS_RATIO - ratio).abs() < 0.005, "{ratio}");
        }
        // The change between the two temperatures is 1.5 to 2 %: the papers differ by a tenth of
        // it.
        let measured = polycrystal(warm)[0] / polycrystal(cold)[0];
        let stated = ice_youngs_modulus(-3.0) / ice_youngs_modulus(-16.0);
        assert!((measured - stated).abs() < 0.003, "{measured} {stated}");
    }

    /// What Lever and others (2022) quote of drop-ball hardness.
    #[test]
    fn hardness_is_what_is_quoted_of_it_at_two_temperatures() {
        for (temperature, quoted) in [(-4.5, 17.4e6), (-5.0, 17.7e6)] {
            assert!((ice_hardness(temperature) / quoted - 1.0).abs() < 1e-12);
        }
    }

    /// The measured range of pressures that ice bears: 10-30 MPa from melting to -20 C.
    #[test]
    fn hardness_falls_towards_melting_within_the_range_of_indentation_tests() {
        assert!((ice_hardness(0.0) - 14.7e6).abs() < 1.0);
        assert!((ice_hardness(-10.0) - 20.7e6).abs() < 1.0);
        assert!(ice_hardness(-20.0) < 30e6 && ice_hardness(-20.0) > ice_hardness(-5.0));
    }
}
