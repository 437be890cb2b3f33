//! The words and numbers of a `.lut` file that its reader and its writer share.

use crate::table::quantity::Quantity;

/// What the key `format` says.
pub(crate) const FORMAT: &str = "kufe-lut";
/// What the key `format_version` says.
pub(crate) const FORMAT_VERSION: u64 = 1;
/// What the key `format_version` says where the second axis holds reduced curvatures.
pub(crate) const REDUCED_VERSION: u64 = 2;

/// What the key `format_version` says where the contacts slide.
pub(crate) const SLIDING_VERSION: u64 = 3;

/// Name and unit of a figure by its key in [`Solved::keys`](crate::Solved::keys).
pub(crate) fn figure(key: &'static str) -> (&'static str, &'static str) {
    match Quantity::ALL.into_iter().find(|q| q.key() == key) {
        Some(quantity) => (quantity.name(), quantity.unit()),
        None => match key.rsplit_once('_') {
            Some((name, "pa")) => (name, "Pa"),
            Some((name, unit @ ("m" | "m2"))) => (name, unit),
            _ => (key, "1"),
        },
    }
}
