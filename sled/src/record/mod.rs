//! Recorded runs: their index, their files, and checks of their columns.

pub mod check;
pub(crate) mod file_names;
pub(crate) mod files;
pub(crate) mod gaps;
pub(crate) mod index;
pub(crate) mod needs;
pub(crate) mod run;
