//! All effects on friction, forces, sensors, sled and track: a new one is a file in the room where it belongs.

use crate::law::Effect;

mod air;
mod friction;
mod grip;
mod sensors;
mod sled;
mod track;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|effect| effect.info.name == name)
}
