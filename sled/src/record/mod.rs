//! Recorded runs: their index, their files, and whether they hold what their names say.

pub mod check;
pub(crate) mod files;
pub(crate) mod gaps;
pub(crate) mod index;
<<<<<<< HEAD
pub(crate) mod needs;
=======
pub(crate) mod matlab;
mod mdf4;
pub(crate) mod parquet;
pub(crate) mod read;
pub(crate) mod read_runs;
>>>>>>> b97b94a2 (telemetry, sled: one reader of text, units as a table, Parquet by logical types, bounded unpacking)
pub(crate) mod run;
