//! The list of all effects, which the build script writes from the files in the rooms.

use crate::case::effects::catalogue::{ice, runner, sensor};
use crate::case::effects::effect::Effect;

include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));
