//! The pressed body and what carries it.

use kufe_fem::ElementKind;

/// The pressed body.
#[derive(Clone, Debug, PartialEq)]
pub struct Ice {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// What the ice rests on.
    pub foundation: Foundation,
    /// Largest pressure the surface bears, where one is stated [Pa].
    pub hardness: Option<f64>,
}

impl Ice {
    /// Elastic ice without end, of a Young's modulus [Pa] and a Poisson's ratio.
    pub fn half_space(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        Ice {
            youngs_modulus,
            poissons_ratio,
            foundation: Foundation::HalfSpace,
            hardness: None,
        }
    }

    /// How it gives as a half-space, (1 - nu^2) / E [1/Pa].
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus
    }

    /// The element of its hexahedra and of its bed's.
    pub fn element_kind(&self) -> ElementKind {
        let ratio = match self.foundation {
            Foundation::ElasticBed { bed, .. } => self.poissons_ratio.max(bed.poissons_ratio),
            Foundation::HalfSpace | Foundation::RigidBed { .. } => self.poissons_ratio,
        };
        ElementKind::of_block(ratio)
    }
}

/// What carries the ice from below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Foundation {
    /// Ice without end: the far field is that of a half-space.
    HalfSpace,
    /// A layer bonded to a rigid bed.
    RigidBed {
        /// Thickness of the layer [m].
        thickness: f64,
    },
    /// A layer bonded to an elastic one, which is bonded to a rigid bed: ice on the concrete of a track.
    ElasticBed {
        /// Thickness of the ice [m].
        thickness: f64,
        /// What it is bonded to.
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
