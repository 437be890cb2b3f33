//! What effects see of a sled and what they may change.

mod conditions;
mod constants;
mod relaxed;
mod series;
mod signals;
mod state;

pub use conditions::Conditions;
pub use constants::Constants;
pub use relaxed::Relaxed;
pub use series::ahead;
pub use signals::{SENSORS, Sensor, Signals};
pub use state::{Forces, State};
