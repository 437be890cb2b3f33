//! Imports from end to end.

mod one_logger;
mod truth;
