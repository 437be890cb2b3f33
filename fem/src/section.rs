//! What a cell is made of and which element integrates it.

use crate::element::hex8::{Corners, ElementMatrix};
use crate::element::{hex8, hex8_axial, hex8_dilatation, hex8_incompatible};
use crate::material::Material;

/// Which eight-node hexahedron.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementKind {
    /// Trilinear, 2 x 2 x 2 Gauss points. Locks where a thin body bends.
    #[default]
    Hex8,
    /// Trilinear with incompatible modes, for bodies that bend.
    Hex8Incompatible,
    /// Trilinear with the shear of planes across its first axis averaged along it, for beams along that axis.
    Hex8Axial,
    /// Trilinear with the mean change of volume, for nearly incompressible materials.
    Hex8Dilatation,
}

impl ElementKind {
    /// The element of a block that does not bend: the plain one, or that with the mean change of volume from a Poisson's ratio
    /// of [`hex8_dilatation::NEARLY_INCOMPRESSIBLE`] on.
    pub fn of_block(poissons_ratio: f64) -> Self {
        if poissons_ratio >= hex8_dilatation::NEARLY_INCOMPRESSIBLE {
            ElementKind::Hex8Dilatation
        } else {
            ElementKind::Hex8
        }
    }
}

/// Material and element of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The material.
    pub material: Material,
    /// The element.
    pub kind: ElementKind,
}

impl Section {
    /// Stiffness matrix (24 x 24) [N/m] of an element with these corners [m].
    pub fn stiffness(&self, corners: &Corners) -> ElementMatrix {
        match self.kind {
            ElementKind::Hex8 => hex8::stiffness(corners, self.material),
            ElementKind::Hex8Incompatible => hex8_incompatible::stiffness(corners, self.material),
            ElementKind::Hex8Axial => hex8_axial::stiffness(corners, self.material),
            ElementKind::Hex8Dilatation => hex8_dilatation::stiffness(corners, self.material),
        }
    }
}
