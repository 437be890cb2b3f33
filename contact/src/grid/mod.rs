//! Positions of nodes: the expected contact patch, and axes graded to it.

pub(crate) mod first_guess;
pub(crate) mod grading;
pub(crate) mod patch;
pub(crate) mod stretch;
