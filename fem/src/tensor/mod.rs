//! The stiffness on a tensor grid, as products of the 1-D matrices of its axes.

pub mod axis;
pub(crate) mod eigen;
mod faces;
mod factors;
mod kernel;
pub mod operator;
#[cfg(test)]
mod operator_tests;
mod row_ends;
mod slab;
mod stencils;
