//! Preconditioners: diagonalised axes, elimination along z, beam motions.

pub mod beam_modes;
pub mod elimination;
pub mod fast_diagonal;
pub mod planewise_diagonal;
