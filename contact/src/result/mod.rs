//! From forces on nodes to pressures, figures and fields.

pub(crate) mod answer;
pub(crate) mod centre_line;
pub(crate) mod chords;
pub(crate) mod column_stress;
pub(crate) mod elsewhere;
pub(crate) mod extents;
pub(crate) mod measure;
pub(crate) mod pressure;
pub(crate) mod runner_loads;
pub(crate) mod solution;
