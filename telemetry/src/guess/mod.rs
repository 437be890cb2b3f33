//! What the channels of a sample may be, and how sure that is.

mod name;
mod sample;
mod value;
mod write;

pub use write::guess_mapping;
