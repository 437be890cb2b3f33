//! What each kind of data says of what a model lacks.

pub mod experiments;
pub mod maps;
pub mod runs;
