//! Values that are a number or a word.

mod hardness;
mod thickness;
mod word_or_number;

pub use hardness::Hardness;
pub use thickness::Thickness;
