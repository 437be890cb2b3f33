//! What each kind of data says of what a model does not contain.

pub mod experiments;
pub mod maps;
pub mod runs;
