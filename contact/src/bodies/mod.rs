//! What bends: the ice and the runner as elastic bodies that meet on the contact plane.

pub(crate) mod columns;
pub(crate) mod elastic_body;
pub(crate) mod far_field;
pub(crate) mod hexahedra;
pub(crate) mod mortar;
pub(crate) mod mounting;
pub(crate) mod runner_body;
pub(crate) mod solid_body;
pub(crate) mod stiffness;
pub(crate) mod trace;
