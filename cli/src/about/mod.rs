//! What the command says of itself and of its files: examples to start from, schemas, manual pages.

pub mod completions;
pub mod examples;
pub mod init;
mod reference;
pub mod schema;
#[cfg(test)]
mod tests;
