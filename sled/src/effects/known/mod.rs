//! What is known of an effect before it is fitted: its name, formula and parameters, what it needs and how it is judged.

mod column;
mod info;
mod judged;
mod parameter;

pub use column::Column;
pub use info::{ActsOn, Form, Info};
pub use judged::{Experiments, Judged, Level};
pub use parameter::{Edge, Parameter};
