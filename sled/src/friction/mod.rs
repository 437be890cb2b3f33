//! Ice friction: longitudinal as a function of pressure, lateral as a function of slip, and fits of
//! both.
//!
//! | item | purpose |
//! |---|---|
//! | [`Longitudinal`], [`PressureLaw`] | mu fixed or as a function of the peak pressure; [`longitudinal_force`] |
//! | [`MagicFormula`], [`Braghin`] | lateral force as a function of slip and load |
//! | [`fit_lateral`] | magic formula from samples, corrected for slip noise |
//! | [`fit_mu`] | quadratic mu(p) from [`Experiment`]s, with errors in both |
//! | [`evaluate_glide`], [`evaluate_ice_house`] | mu by specimen from gliding runs |
//! | [`Response`] | response surface for the minimum of an expensive function |
//! | [`film`] | the melt film under a runner, from heat and water balance |
//!
//! ```
//! use kufe_sled::friction::{Longitudinal, MagicFormula, longitudinal_force};
//! let mu = Longitudinal::PUBLISHED.mu(11.42e6);
//! let fx = longitudinal_force(2000.0, 0.01, mu);
//! let fy = MagicFormula::PUBLISHED_REAR.force(0.01, 2000.0);
//! assert!(fx < 0.0 && fy > 20.0 * fx.abs());
//! ```

mod estimate;
mod experiments;
pub mod film;
mod glide_run;
mod lateral;
mod least_squares;
mod longitudinal;
mod specimens;

pub use estimate::{Estimate, Response, Span};
pub use experiments::{Experiment, read_experiments, write_experiments};
pub use glide_run::{
    GRAVITY, GlideRun, LineFit, SHARE_LEFT_OUT, air_density, evaluate_glide, fit_line,
};
pub(crate) use lateral::fit::CONFIDENCE;
pub use lateral::fit::{Interval, LateralFit, fit_lateral};
pub use lateral::law::{Braghin, LateralAngles, LateralDerivatives, MagicFormula, sin_cos_near};
pub use lateral::{Combination, LateralFitOptions, LateralSample};
pub use longitudinal::law::{
    Longitudinal, LongitudinalKeys, PressureLaw, ZetaActsOn, longitudinal_force,
};
pub use longitudinal::{LeastFriction, MuFit, Weighting, fit_mu};
pub use specimens::{
    GlideEntry, GlidePair, GlideTrace, IceHouse, SpecimenFriction, evaluate_ice_house, read_glide,
    read_glide_index,
};
