//! What can be proved of channels by one another: a rigid body that moves along its way, weighed by its accelerometers.

pub(crate) mod channels;
pub(crate) mod judge;
mod response;
pub(crate) mod rigid_body;
