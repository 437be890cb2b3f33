//! The stiffness of hexahedra applied without being stored, four cells at a time.

mod derivatives;
mod hex8_lanes;
mod lanes;
pub mod operator;
