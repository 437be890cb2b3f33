//! The search for effects that are missing in a model, over runs, experiments, maps and campaigns.

mod campaign;
mod experiments;
pub(crate) mod friction_table;
mod pressures;
mod runs;
mod wrong;
