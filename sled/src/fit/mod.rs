//! Lateral friction of both runners from measured runs.

pub(crate) mod contacts;
pub(crate) mod own_contacts;
pub(crate) mod runners;
pub(crate) mod samples;
