//! Ice friction: longitudinal over pressure, lateral over slip, and the fits of both.
//!
//! | item | purpose |
//! |---|---|
//! | [`Longitudinal`], [`PressureLaw`] | mu fixed or over peak pressure; [`longitudinal_force`] |
//! | [`MagicFormula`], [`Braghin`] | lateral force over slip and load |
//! | [`fit_lateral`] | magic formula from samples, with slip noise corrected |
//! | [`fit_mu`] | quadratic mu(p) from [`Experiment`]s, with errors in both |
//! | [`evaluate_glide`], [`evaluate_ice_house`] | mu by specimen from gliding runs |
//! | [`film`] | the melt film under a runner, from heat and water balance |
//!
//! ```
//! use kufe_friction::{Longitudinal, MagicFormula, longitudinal_force};
//! let mu = Longitudinal::PUBLISHED.mu(11.42e6);
//! let fx = longitudinal_force(2000.0, 0.01, mu);
//! let fy = MagicFormula::PUBLISHED_REAR.force(0.01, 2000.0);
//! assert!(fx < 0.0 && fy > 20.0 * fx.abs());
//! ```

pub mod effects;
mod error;
mod estimate;
mod experiments;
pub mod film;
mod glide_run;
mod glides;
mod icehouse;
mod icehouse_plot;
mod lateral;
mod lateral_fit;
mod lateral_identifiability;
mod lateral_least_squares;
mod lateral_root;
mod lateral_score;
mod line_fit;
mod longitudinal;
mod mu_plot;
mod mu_pressure_fit;
mod orthogonal_distance;
mod table;

pub use error::Error;
pub use estimate::Estimate;
pub use experiments::{Experiment, read_experiments, write_experiments};
pub use glide_run::{
    GAS_CONSTANT_OF_AIR, GRAVITY, GlideRun, SHARE_LEFT_OUT, air_density, evaluate_glide,
};
pub use glides::{GlideEntry, GlideTrace, read_glide, read_glide_index};
pub use icehouse::{GlidePair, IceHouse, SpecimenFriction, evaluate_ice_house};
pub use icehouse_plot::draw_glide;
pub use lateral::{Braghin, LateralDerivatives, MagicFormula};
pub use lateral_fit::{LateralFit, LateralFitOptions, fit_lateral};
pub use lateral_identifiability::{Combination, Identifiability};
pub use lateral_score::LateralSample;
pub use line_fit::{LineFit, fit_line};
pub use longitudinal::{
    Longitudinal, LongitudinalKeys, PressureLaw, ZetaActsOn, longitudinal_force,
};
pub use mu_plot::draw_mu_over_pressure;
pub use mu_pressure_fit::{LeastFriction, MuFit, Weighting, fit_mu};
