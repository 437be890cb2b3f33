//! What a search for missing effects has found, as a page without scripts.

mod bars;
mod data;
mod diagram;
mod maps;
mod page;
mod parts;
mod peaks;
mod sections;
mod strip;
mod summary;

pub use page::discovery_page;
