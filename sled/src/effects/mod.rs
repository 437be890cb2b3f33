//! Effects: physics that can be added to the base model of a sled on ice, each with a switch.
//!
//! An effect is one entry of the catalogue: law, formula, source, an example with its expected
//! number, and its signature in data. The same code acts in the driving simulation and in the
//! inverse model: an effect changes the friction coefficient or the forces of the base law, is a
//! fault of a sensor, changes a constant of the sled or the track's slope. At default parameters it
//! changes nothing.
//!
//! Effects on pressures change a contact problem. They are in the crate `kufe`, with the same
//! [`Info`].
//!
//! | type | purpose |
//! |---|---|
//! | [`Effect`], [`Info`], [`CATALOGUE`] | one effect, its description, all of them |
//! | [`OperatingPoint`], [`State`], [`Signals`] | input of an effect: of a runner, of a sled, of the sensors |
//! | [`Forces`], [`Sled`](crate::Sled) | quantities that it may change besides signals |
//! | [`Effects`], [`Active`], [`Custom`] | the effects that a model switches on, including expressions |
//!
//! ```
//! use kufe_sled::effects::{Sensor, Signals, find};
//! let fault = find("slip-scale").unwrap();
//! let mut signals = Signals::default();
//! signals[Sensor::Slip] = 0.40;
//! fault.disturb(&[0.05], &mut signals);
//! assert!((signals[Sensor::Slip] - 0.42).abs() < 1e-12);
//! ```

mod catalogue;
mod custom;
mod description;
mod effect;
mod expression;
mod series;
mod state;
mod switched;

pub use crate::column::{Column, SENSORS, Sensor};
pub use catalogue::{CATALOGUE, find, read_catalogue};
pub use custom::{Channel, Custom, columns_of_forces, columns_of_sensors, is_column};
pub use description::{ActsOn, Edge, Experiments, Form, Info, Judged, Level, Parameter};
pub use effect::{Effect, Fault, Reading};
pub use expression::{Expression, ExpressionError};
pub use series::{Relaxed, ahead};
pub use state::{Forces, OperatingPoint, Signals, State};
pub use switched::{Active, EffectError, Effects, Kind, schema};
