//! Undersides in closed form: runners from a rocker and a section, and the paraboloid.

pub(crate) mod bob_runner;
pub(crate) mod lows;
pub(crate) mod luge_steel;
pub(crate) mod paraboloid;
pub(crate) mod points_file;
pub(crate) mod profile;
pub(crate) mod rocker;
pub(crate) mod section;
pub(crate) mod swept;
pub(crate) mod underside;

pub use bob_runner::BobRunner;
pub use luge_steel::LugeSteel;
pub use paraboloid::Paraboloid;
pub use points_file::load_points;
pub use profile::Profile;
pub use rocker::Rocker;
pub use section::Section;
pub use swept::{Ends, Swept};
pub use underside::Underside;
