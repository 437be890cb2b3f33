//! Several kinds of data of one campaign in one search: `campaign.toml`, each kind's evidence, and what they say together.

pub(crate) mod combine;
pub(crate) mod description;
pub(crate) mod evidence;
pub(crate) mod file;
pub(crate) mod indexed;
pub(crate) mod kinds;
pub(crate) mod screen;
pub(crate) mod search;
#[cfg(test)]
mod tests;
