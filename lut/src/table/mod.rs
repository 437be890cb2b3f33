//! A table: its breakpoints, its figures, and their evaluation between them.

pub(crate) mod axes;
pub(crate) mod flush;
pub(crate) mod layered;
pub(crate) mod lookup;
pub(crate) mod measure;
pub(crate) mod mode;
pub(crate) mod nodes;
pub(crate) mod pitch;
pub(crate) mod place;
pub(crate) mod quantity;
pub(crate) mod smooth;
pub(crate) mod solved;

pub use axes::{Axes, MAX_AXIS, MAX_NODES};
pub use flush::Flush;
pub use layered::Layered;
pub use lookup::{Looked, Lookup};
pub use measure::Measured;
pub use mode::Mode;
pub use nodes::{Check, Table};
pub use pitch::{MIN_SPEED, curvature_from_pitch, radius_from_pitch};
pub use quantity::Quantity;
pub use solved::{Errors, Method, Point, Sliding, Solved};
