//! What forces on the contact plane move there, dense or through the modes of the plane, and the equations of a closed set on it.

pub(crate) mod closed_set;
pub(crate) mod line_sweep;
pub(crate) mod matrix;
pub(crate) mod modal;
pub(crate) mod window;
