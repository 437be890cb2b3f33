//! What stands in for the inverse stiffness in conjugate gradients: diagonalised axes, elimination along z, beam motions.

pub mod beam_modes;
mod dense;
pub mod elimination;
pub mod fast_diagonal;
pub mod mapped;
pub mod planewise_diagonal;
pub mod single_precision;
