//! Sliding: a case's groove, its melt film, and the friction that they make.

mod film;
mod groove_file;
mod keys;
mod slid;
mod table;

pub use film::{FilmAlong, film_along};
pub(crate) use slid::solve_sliding;
pub use slid::{Friction, Slid};
pub use table::{FrictionPoint, friction_table};
