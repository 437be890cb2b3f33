//! Sliding: a case's groove, its melt film, and the friction that they make.

mod film;
mod groove_file;
mod keys;
mod slid;
mod table;

pub use film::{FilmAlong, film_along};
pub use slid::{Friction, Slid};
pub(crate) use slid::{conditions, film_failure, groove, solve_sliding};
pub(crate) use table::at;
pub use table::{FrictionPoint, friction_table};
