//! Imports from end to end.

mod clocks;
mod one_logger;
mod truth;
