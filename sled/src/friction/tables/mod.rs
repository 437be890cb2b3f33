//! Tables of measurements, read with every cell checked.

pub mod experiments;
pub mod table;
