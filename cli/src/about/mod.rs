//! What the command says of itself and of its files: examples to start from, schemas, manual pages,
//! the machine.

pub mod completions;
pub mod doctor;
pub mod examples;
pub mod init;
#[cfg(test)]
mod option_tests;
mod reference;
pub mod schema;
