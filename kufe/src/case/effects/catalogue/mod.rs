//! All effects on pressures: a new one is a file in the room where it belongs.

mod find;
mod ice;
mod list;
mod runner;
mod sensor;

pub use find::find;
pub use list::CATALOGUE;
