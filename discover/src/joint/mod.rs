//! Joint search of the data of a campaign: `campaign.toml`, each kind's evidence, combination.

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
