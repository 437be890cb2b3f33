//! What a search for missing effects has found, as a page without scripts.

mod bars;
mod data;
mod diagram;
mod maps;
mod sections;

pub use sections::discovery_page;
