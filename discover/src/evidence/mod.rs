//! Evidence of each kind of data.

pub mod experiments;
pub mod maps;
pub mod runs;
