//! The contact on one mesh: both bodies on the nodes of one contact plane.

pub(crate) mod assembled;
pub(crate) mod contact_mesh;
pub(crate) mod discretise;
