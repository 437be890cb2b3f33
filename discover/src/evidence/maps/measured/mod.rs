//! Pressure measurements with the errors of their pixels.

pub(crate) mod noise;
pub(crate) mod rows;
