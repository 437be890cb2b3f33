//! Hulls, fits and meshes from outside the crate, each chapter a module.

mod fitted_underside;
mod readers;
mod vtu_in_python;
