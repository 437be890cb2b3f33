//! The stiffness on a tensor grid, as products of the 1-D matrices of its axes.

pub mod axis;
mod factors;
mod kernel;
pub mod operator;
mod slab;
mod stencils;
