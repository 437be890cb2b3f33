//! Undersides in closed form: runners from a rocker and a section, and the paraboloid.

pub(crate) mod profile;
pub(crate) mod section;
pub(crate) mod swept;
pub(crate) mod underside;

pub use profile::{Profile, load_points};
pub use section::{Rocker, Section};
pub use swept::{BobRunner, Ends, LugeSteel, Swept};
pub use underside::{Paraboloid, Underside};
