//! The list of all effects, which the build script writes from the files in the rooms.

use crate::effects::catalogue::{ice, runner, sensor};
use crate::effects::effect::Effect;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));
