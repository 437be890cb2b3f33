//! Screens: scores and p-values of candidates within runs, between them and on the track.

pub(crate) mod between_runs;
mod exchange;
pub(crate) mod levels;
pub(crate) mod place;
pub(crate) mod residual_screen;
pub(crate) mod track;
pub(crate) mod within_runs;
