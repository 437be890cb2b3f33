//! Where nodes go: the patch in contact and the axes that are graded to it.

pub(crate) mod first_guess;
pub(crate) mod grading;
pub(crate) mod patch;
pub(crate) mod stretch;
