//! Recorded runs: their index, their files in four formats, and whether they hold what their names say.

pub mod check;
pub(crate) mod columns;
pub(crate) mod csv;
pub(crate) mod index;
mod matlab;
#[cfg(feature = "mdf4")]
mod mdf4;
pub(crate) mod parquet;
pub(crate) mod read;
pub(crate) mod read_runs;
pub(crate) mod run;
pub(crate) mod write;
