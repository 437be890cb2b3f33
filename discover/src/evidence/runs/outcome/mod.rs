//! Results of a search over runs: misfits, bins, intervals and the next model.

pub(crate) mod adequacy;
pub(crate) mod bins;
pub(crate) mod choose;
pub(crate) mod conclude;
pub(crate) mod experimental_design;
pub(crate) mod explained;
pub(crate) mod final_estimates;
pub(crate) mod held_out_misfit;
pub(crate) mod insignificant_steps;
pub(crate) mod misfits;
pub(crate) mod next_model;
pub(crate) mod pictures;
pub(crate) mod replays;
pub(crate) mod run_plans;
