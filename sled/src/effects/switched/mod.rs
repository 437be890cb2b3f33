//! The effects that a model switches on: read from its tables, checked, and acting one after the other.

mod active;
mod channel;
mod columns;
mod custom;
mod effects;
mod error;
mod read;
mod schema;

pub use active::{Active, Kind};
pub use channel::Channel;
pub use columns::{columns_of_forces, columns_of_sensors, is_column};
pub use custom::Custom;
pub use effects::Effects;
pub use error::EffectError;
pub use schema::schema;
