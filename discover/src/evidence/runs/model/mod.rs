//! Residuals of the one-track model and their derivatives.

pub(crate) mod channels;
pub(crate) mod design;
pub(crate) mod discrepancy;
pub(crate) mod installation;
pub(crate) mod instant;
pub(crate) mod on_run;
pub(crate) mod readings;
pub(crate) mod repeatable;
pub(crate) mod residual_jacobian;
pub(crate) mod residual_model;
pub(crate) mod whiten;
pub(crate) mod windows;
