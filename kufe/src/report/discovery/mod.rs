//! What a search for missing effects has found, as a page without scripts.

mod page;
mod parts;
mod pictures;
mod sections;
mod summary;

pub use page::discovery_page;
