//! What every command shares: global options, progress, what it says, and files that are whole or absent.

pub mod apart;
pub mod documents;
pub mod global;
pub mod held;
pub mod marks;
pub mod mat;
mod progress;
pub mod say;
pub mod staging;
pub mod watched;
