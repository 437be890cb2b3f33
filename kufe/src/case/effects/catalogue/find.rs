//! An effect by its name.

use crate::case::effects::catalogue::list::CATALOGUE;
use crate::case::effects::effect::Effect;

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    let mut all = CATALOGUE.iter().copied();
    all.find(|effect| effect.info.name == name)
}
