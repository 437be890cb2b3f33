//! All effects on friction, forces, sensors, sled and track: a new one is a file in the room where it belongs.

mod air;
mod angles;
mod find;
mod friction;
mod grip;
mod gyros;
mod list;
mod sensors;
mod sled;
mod track;

pub use find::find;
pub use list::CATALOGUE;
