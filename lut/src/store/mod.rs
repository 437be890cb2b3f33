//! A sweep kept on disk: its results, its shards, and the scripts that run them.
//!
//! A plan's folder holds `plan.json` ([`Manifest`]: the points of one round) and `points/` (a [`Store`]). Shard `i` of
//! `n` solves its share of the points that have no result; running it again does nothing. When
//! all are there, [`next_batch`] either gives the table or, where a tolerance rules the sweep, the next round's points.

pub(crate) mod manifest;
pub(crate) mod replay;
pub(crate) mod results;
pub(crate) mod script;
pub(crate) mod shards;

pub use manifest::Manifest;
pub use replay::{Next, next_batch};
pub use results::{Origin, Store, sha256};
pub use script::{parallel as parallel_script, slurm as slurm_script};
pub use shards::{Done, solve_missing};
