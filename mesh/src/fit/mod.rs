//! A smooth underside fitted to the vertices of a hull.

pub(crate) mod arc_length;
pub(crate) mod b_spline;
pub(crate) mod bicubic;
pub(crate) mod break_places;
pub(crate) mod downward;
pub(crate) mod fitted_underside;
pub(crate) mod judgement;
pub(crate) mod least_squares;
pub(crate) mod normal_equations;
pub(crate) mod refinement;
pub(crate) mod scans;
pub(crate) mod surface;

pub use fitted_underside::FittedUnderside;
pub use judgement::{Coarse, FitQuality};
pub use scans::Scans;
