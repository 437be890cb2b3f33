//! The stiffness on a tensor grid, as products of the 1-D matrices of its axes.

pub mod axis;
mod factors;
mod kernel;
pub mod operator;
#[cfg(test)]
mod operator_tests;
mod slab;
mod stencils;
