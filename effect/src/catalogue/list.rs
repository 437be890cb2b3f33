//! The list of all effects, which the build script writes from the files in the rooms.

use crate::catalogue::{air, angles, friction, grip, gyros, sensors, sled, track};
use crate::law::Effect;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));
