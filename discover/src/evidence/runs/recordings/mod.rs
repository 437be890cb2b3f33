//! Recorded runs: reading and signal processing.

pub(crate) mod available;
pub(crate) mod frame;
pub(crate) mod noise;
pub(crate) mod place_scales;
pub(crate) mod prepare;
pub(crate) mod read;
pub(crate) mod smooth;
pub(crate) mod smooth_run;
pub(crate) mod survey;
pub(crate) mod training_samples;
