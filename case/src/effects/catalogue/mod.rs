//! All effects on pressures: a new one is a file in the room where it belongs.

use crate::effects::effect::Effect;

mod ice;
mod runner;
mod sensor;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|effect| effect.info.name == name)
}
