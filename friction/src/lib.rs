//! Ice friction: longitudinal over pressure, lateral over slip, and the fits of both.
//!
//! | item | purpose |
//! |---|---|
//! | [`Longitudinal`], [`PressureLaw`] | mu fixed or over peak pressure; [`longitudinal_force`] |
//! | [`MagicFormula`], [`Braghin`] | lateral force over slip and load |
//! | [`fit_lateral`] | magic formula from samples, with slip noise corrected |
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
mod lateral;
mod lateral_fit;
mod lateral_identifiability;
mod lateral_least_squares;
mod lateral_score;
mod longitudinal;

pub use error::Error;
pub use lateral::{Braghin, LateralDerivatives, MagicFormula};
pub use lateral_fit::{Estimate, LateralFit, LateralFitOptions, fit_lateral};
pub use lateral_identifiability::{Combination, Identifiability};
pub use lateral_score::LateralSample;
pub use longitudinal::{
    Longitudinal, LongitudinalKeys, PressureLaw, ZetaActsOn, longitudinal_force,
};
