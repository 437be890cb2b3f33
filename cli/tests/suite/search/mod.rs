//! The search for what a model lacks, over runs, experiments, maps and campaigns.

mod campaign;
mod experiments;
pub(crate) mod friction_table;
mod pressures;
mod runs;
mod wrong;
