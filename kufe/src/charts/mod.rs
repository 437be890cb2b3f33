//! Pictures of tables, glides, fits, validations, evaluations and runs.

mod distributions;
mod friction;
mod odd_curve;
mod series;
mod table;

pub use distributions::{angle_picture, energy_picture, rmse_picture};
pub use friction::{fit_picture, glide_picture, mu_picture};
pub use odd_curve::{OddCurve, odd_curves};
pub use series::{
    force_picture, lateral_force_picture, losses_picture, replay_picture, run_picture,
};
pub use table::{TablePicture, table_picture};
