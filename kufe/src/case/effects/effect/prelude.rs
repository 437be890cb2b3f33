//! What the file of an effect is written with.

pub(crate) use crate::case::effects::effect::description::Effect;
pub(crate) use crate::case::effects::effect::example::{Example, Measure};
pub(crate) use crate::case::effects::effect::search::{Adds, Growth, Search};
pub(crate) use kufe_sled::effects::{ActsOn, Form, Info, Parameter};
pub(crate) use std::sync::Arc;
