//! Contact pressures by boundary elements.

pub mod fourier;
pub mod half_space;
