//! Imports from end to end.

mod clocks;
mod guessed;
mod one_logger;
mod truth;
