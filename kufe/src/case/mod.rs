//! The file that states one contact problem, `case.toml`.
//!
//! [`Case`] mirrors the file key by key; [`Case::parse`] reads and checks it, [`Case::problem`]
//! turns it into a [`Problem`](kufe_contact::Problem). Unknown keys are errors, and every error
//! names the line, the key, the value found and what was expected.
//!
//! ```
//! use kufe::case::Case;
//! let case = Case::parse(
//!     "[runner]\n\
//!      shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
//!      [ice]\n\
//!      youngs_modulus_pa = 9.0e9\n\
//!      poissons_ratio = 0.33\n\
//!      thickness_m = \"half-space\"\n\
//!      [load]\n\
//!      fz_n = 1000.0\n",
//! )?;
//! assert_eq!(case.load.fz_n, 1000.0);
//! assert_eq!(case.track.curvature(), 0.0);
//! # Ok::<(), kufe::case::CaseError>(())
//! ```

mod check;
mod document;
pub mod effects;
mod error;
mod fitted_hull;
mod problem;
mod range;
mod runner;
mod tables;

pub use document::{Case, GROOVE_FILE};
pub use error::CaseError;
pub use fitted_hull::FittedHull;
pub use range::{LARGEST_RADIUS, RANGES, Range};
pub use runner::{CarriesTable, FileAxis, HeldTable, MountTable, RunnerTable, SectionTable, Shape};
pub use tables::{
    AccuracyTable, BedTable, Hardness, HardnessTable, IceTable, LoadTable, SlidingTable,
    SolverTable, StiffnessWord, Thickness, TiltWord, TrackTable, WavinessTable,
};
