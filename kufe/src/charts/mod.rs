//! Pictures of tables, glides, fits, validations, evaluations and runs.

mod boxes;
mod evaluation;
mod fit;
mod glide;
mod mu;
mod replay;
mod run;
mod samples;
mod strip;
mod table;
mod validation;

pub use boxes::Spread;
pub use evaluation::{angle_picture, energy_picture, force_picture};
pub use fit::fit_picture;
pub use glide::draw_glide;
pub use mu::draw_mu_over_pressure;
pub use replay::replay_picture;
pub use run::run_picture;
pub use table::{DrawTableError, Slice, draw};
pub use validation::{lateral_force_picture, rmse_picture};
