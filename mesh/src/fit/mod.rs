//! A smooth underside fitted to the vertices of a hull.

pub(crate) mod arc_length;
pub(crate) mod b_spline;
pub(crate) mod band_cholesky;
pub(crate) mod bicubic;
pub(crate) mod break_places;
pub(crate) mod downward;
pub(crate) mod fitted_underside;
pub(crate) mod least_squares;
pub(crate) mod refinement;

pub use fitted_underside::{Coarse, FitQuality, FittedUnderside};
