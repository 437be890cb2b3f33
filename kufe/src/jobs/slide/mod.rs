//! Sliding: a case's groove, its melt film, and the friction that they make.

mod ploughing;
mod sensitivity;
mod sliding;
mod table;

pub use ploughing::{Hardness, HardnessFrom};
pub(crate) use ploughing::{Ploughing, SolvedGroove};
pub use sliding::{FilmAlong, SolvedSliding};
pub(crate) use sliding::{conditions, film_along, film_on, solve_sliding};
pub use table::{Optimum, Parameter, SolvedTable, friction_table, lowest_friction, optimise};
pub(crate) use table::{sliding_table, with_speed_and_temperature};
