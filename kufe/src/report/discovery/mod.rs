//! The page of a search for missing effects, without scripts.

mod page;
mod parts;
mod pictures;
mod sections;
mod summary;

pub use page::discovery_page;
