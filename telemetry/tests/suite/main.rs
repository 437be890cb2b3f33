//! Imports from end to end.

mod clocks;
mod guessed;
mod makers;
mod one_logger;
mod truth;
