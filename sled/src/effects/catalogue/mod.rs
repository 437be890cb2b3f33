//! All effects on friction, forces, sensors, sled and track, a table for each family.
//!
//! A new effect is an entry of its family's table: description, an example with the number that
//! it must give, and its law.

mod air;
mod friction;
mod grip;
mod sensors;
mod sled;
mod track;

use crate::effects::effect::Effect;

const FAMILIES: [&[Effect]; 8] = [
    air::EFFECTS,
    sensors::ANGLES,
    friction::EFFECTS,
    grip::EFFECTS,
    sensors::GYROS,
    sensors::ACCELEROMETER_AND_SPEED,
    sled::EFFECTS,
    track::EFFECTS,
];

const COUNT: usize = {
    let (mut sum, mut family) = (0, 0);
    while family < FAMILIES.len() {
        sum += FAMILIES[family].len();
        family += 1;
    }
    sum
};

/// All effects, family by family.
pub static CATALOGUE: &[&Effect] = &{
    let mut all = [&FAMILIES[0][0]; COUNT];
    let (mut at, mut family) = (0, 0);
    while family < FAMILIES.len() {
        let mut i = 0;
        while i < FAMILIES[family].len() {
            all[at] = &FAMILIES[family][i];
            at += 1;
            i += 1;
        }
        family += 1;
    }
    all
};

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    let mut all = CATALOGUE.iter().copied();
    all.find(|effect| effect.info.name == name)
}
