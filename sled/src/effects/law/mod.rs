//! One effect: what is known of it, its law on whatever it acts on, and an example with the number it must give.

mod effect;
mod example;
mod fault;
mod outcome;
pub(crate) mod prelude;

pub use effect::Effect;
pub use example::Example;
pub use fault::{Fault, Reading};
