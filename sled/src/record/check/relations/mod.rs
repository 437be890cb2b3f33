//! What can be proved of channels by one another: a rigid body that moves along its way, weighed by its accelerometers.

mod coefficients;
pub(crate) mod delay;
pub(crate) mod fault;
pub(crate) mod judge;
mod mend;
pub(crate) mod plain;
mod range;
mod response;
mod rigid_body;
pub(crate) mod rules;
pub(crate) mod slow;
