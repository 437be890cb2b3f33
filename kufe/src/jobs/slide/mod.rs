//! Sliding: a case's groove, its melt film, and the friction that they make.

mod film;
mod groove;
mod hardness;
mod optimum;
mod result;
mod sensitivity;
mod sliding;
mod table;

pub use film::{FilmAlong, film_along};
pub(crate) use film::{conditions, film_failure, film_on};
pub use groove::Hardness;
pub(crate) use groove::{Grooved, Ploughing};
pub use hardness::HardnessFrom;
pub use optimum::{Optimum, Parameter, fastest, optimise};
pub use sensitivity::Sensitivity;
pub(crate) use sliding::solve_sliding;
pub use sliding::{Friction, SolvedSliding};
pub(crate) use table::at;
pub use table::{FrictionPoint, friction_table};
