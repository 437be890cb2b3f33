//! The eight-node hexahedra: their matrices, strains and faces.

pub mod face;
pub mod hex8;
pub mod hex8_axial;
pub mod hex8_dilatation;
pub mod hex8_incompatible;
