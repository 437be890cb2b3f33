//! Names that the tables of effects are written with.

pub(crate) use crate::effects::description::{
    ActsOn, Column, Experiments, Form, Info, Judged, Parameter, amplitude, setting,
};
pub(crate) use crate::effects::effect::{Effect, Fault};
pub(crate) use crate::effects::state::Sensor;
