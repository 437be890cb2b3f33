//! Where nodes go: the patch that is expected, axes graded to it, and the mesh with everything an iteration needs.

pub(crate) mod assembled;
pub(crate) mod contact_mesh;
pub(crate) mod corners;
pub(crate) mod discretise;
pub(crate) mod first_guess;
pub(crate) mod grading;
pub(crate) mod limits;
pub(crate) mod patch;
pub(crate) mod sliding_patch;
pub(crate) mod stretch;
pub(crate) mod zones;
