//! Sliding: a case's groove, its melt film, and the friction that they make.

mod film;
mod friction;
mod groove;
mod groove_file;
mod hardness;
mod keys;
mod optimum;
mod sensitivity;
mod slid;
mod table;

pub use film::{FilmAlong, film_along};
pub use friction::Friction;
pub use groove::Hardness;
pub use hardness::HardnessFrom;
pub use optimum::{Optimum, Parameter, fastest, optimise};
pub use sensitivity::Sensitivity;
pub use slid::Slid;
pub(crate) use slid::solve_sliding;
pub use table::{FrictionPoint, friction_table};
