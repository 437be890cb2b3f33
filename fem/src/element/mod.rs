//! The eight-node hexahedra: their matrices and strains, and the faces that carry loads.

pub mod face;
pub mod hex8;
pub mod hex8_axial;
pub mod hex8_dilatation;
pub mod hex8_incompatible;
