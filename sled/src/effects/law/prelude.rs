//! What the file of an effect is written with.

pub(crate) use crate::effects::known::{
    ActsOn, Column, Experiments, Form, Info, Judged, Parameter,
};
pub(crate) use crate::effects::law::effect::Effect;
pub(crate) use crate::effects::law::example::Example;
pub(crate) use crate::effects::law::fault::Fault;
pub(crate) use crate::effects::motion::Sensor;
