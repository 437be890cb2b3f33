//! The list of all effects, which the build script writes from the files in the rooms.

use crate::catalogue::{air, friction, grip, sensors, sled, track};
use crate::law::Effect;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));
