//! Contacts with walls that differ from run to run.

pub(crate) mod find;
pub(crate) mod grip;
pub(crate) mod hit;
pub(crate) mod levers;
pub(crate) mod likelihood;
pub(crate) mod model;
mod pushes;
pub(crate) mod report;
pub(crate) mod run_contacts;
pub(crate) mod selection;

/// Smallest number of runs that hit a place: a contact of a single run is not a property of the
/// track.
const MIN_HITS: usize = 2;
