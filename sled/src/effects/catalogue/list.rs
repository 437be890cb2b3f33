//! The list of all effects, which the build script writes from the files in the rooms.

use crate::effects::catalogue::{air, angles, friction, grip, gyros, sensors, sled, track};
use crate::effects::law::Effect;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));
