//! The stiffness of hexahedra applied without being stored, four cells at a time.

mod lanes;
pub mod operator;
