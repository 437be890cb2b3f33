//! Closed forms and plain methods that the solver is compared with.

pub(crate) mod hertz;
pub(crate) mod own_set;
pub(crate) mod plain;
pub(crate) mod plain_runner;
pub(crate) mod rigid_plastic;
