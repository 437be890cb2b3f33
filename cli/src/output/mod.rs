//! What every command shares: global options, progress, messages, and outputs that are complete
//! or absent.

pub mod documents;
pub mod file;
pub mod folder;
pub mod global;
pub mod marks;
pub mod paths;
mod progress;
pub mod say;
pub mod watched;
