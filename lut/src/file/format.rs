//! The words and numbers of a `.lut` file that its reader and its writer share.

use crate::table::quantity::Quantity;

/// What the key `format` says.
pub(crate) const FORMAT: &str = "kufe-lut";
/// What the key `format_version` says.
pub(crate) const FORMAT_VERSION: u64 = 1;
/// What the key `format_version` says where the second axis holds reduced curvatures.
pub(crate) const REDUCED_VERSION: u64 = 2;

/// Name and unit of a figure of [`Solved::to_array`].
pub(crate) fn figure(n: usize) -> (&'static str, &'static str) {
    match n {
        0 => (Quantity::PMax.name(), Quantity::PMax.unit()),
        1 => ("p_max_error", "Pa"),
        _ => (Quantity::ALL[n - 1].name(), Quantity::ALL[n - 1].unit()),
    }
}
