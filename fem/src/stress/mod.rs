//! Strains and stresses of a displaced body, and numbers that sum them up.

pub mod field;
pub mod measures;
pub mod on_grid;
