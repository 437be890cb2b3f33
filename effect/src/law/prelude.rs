//! What the file of an effect is written with.

pub(crate) use crate::known::{ActsOn, Column, Experiments, Form, Info, Judged, Parameter};
pub(crate) use crate::law::effect::Effect;
pub(crate) use crate::law::example::Example;
pub(crate) use crate::law::fault::Fault;
pub(crate) use crate::motion::Sensor;
