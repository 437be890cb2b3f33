//! The documents of a search: see [`kufe::results::finding`].

pub use kufe::results::finding::*;
