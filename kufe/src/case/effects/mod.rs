//! Effects that can be hidden in a measured pressure map: parts of the problem, or of the sensor, with a switch and one parameter.

mod catalogue;
mod effect;
pub(crate) mod schema;
mod switch;
mod underside;

pub use catalogue::{CATALOGUE, find};
pub use effect::{Adds, Effect, Example, Growth, Map, Measure, Search};
pub use kufe_sled::effects::{Form, Info, Parameter};
pub(crate) use switch::switch_on;
