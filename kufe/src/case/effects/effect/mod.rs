//! What an effect on pressures is: its laws, how a search follows it, and an example with the number it must give.

mod description;
mod example;
mod map;
pub(super) mod prelude;
mod search;

pub use description::Effect;
pub use example::{Example, Measure};
pub use map::Map;
pub use search::{Adds, Growth, Search};
