//! Pictures of fits, validations, evaluations and runs.

mod boxes;
mod evaluation;
mod fit;
mod replay;
mod run;
mod strip;
mod validation;

pub use boxes::Spread;
pub use evaluation::{angle_picture, energy_picture, force_picture};
pub use fit::fit_picture;
pub use replay::replay_picture;
pub use run::run_picture;
pub use validation::{lateral_force_picture, rmse_picture};
