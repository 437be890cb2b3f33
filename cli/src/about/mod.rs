//! Help and files to start from: examples, schemas, manual pages, completions.

pub mod completions;
pub mod examples;
pub mod init;
pub mod schema;
#[cfg(test)]
mod tests;
