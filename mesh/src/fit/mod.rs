//! A smooth underside fitted to the vertices of a hull.

pub(crate) mod downward;
pub(crate) mod fitted_underside;
pub(crate) mod judgement;
pub(crate) mod knots;
pub(crate) mod scans;
pub(crate) mod spline;

pub use fitted_underside::FittedUnderside;
pub use judgement::{FitQuality, smaller_by};
pub use scans::Scans;
