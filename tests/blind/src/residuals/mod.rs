//! What an inversion leaves: size and likeness of effects in it.

pub mod inverse;
pub mod least_squares;
pub mod signature;
pub mod sizing;
