//! Sliding: a case's groove, its melt film, and the friction that they make.

mod film;
mod friction;
mod groove;
mod groove_file;
mod hardness;
mod optimum;
mod sensitivity;
mod slid;
mod table;

pub use film::{FilmAlong, film_along};
pub(crate) use film::{conditions, film_failure};
pub use friction::Friction;
pub use groove::Hardness;
pub(crate) use groove::{Grooved, Ploughing};
pub use hardness::HardnessFrom;
pub use optimum::{Optimum, Parameter, fastest, optimise};
pub use sensitivity::Sensitivity;
pub use slid::SolvedSliding;
pub(crate) use slid::solve_sliding;
pub(crate) use table::at;
pub use table::{FrictionPoint, friction_table};
