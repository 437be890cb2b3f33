//! Frictionless contact of a runner on ice.
//!
//! | type | what it is |
//! |---|---|
//! | [`Problem`] | runner, ice, track and load |
//! | [`Options`] | accuracy and limits |
//! | [`solve`] | problem in, solution out |
//! | [`Solution`] | pressure field, figures, history |
//! | [`hertz`] | closed form for smooth point contacts |
//!
//! How a problem becomes a pressure:
//!
//! 1. `window` guesses the patch from the undeformed gap; `scout` finds it with contact problems on the contact plane
//!    alone, whose matrix is the Green's matrix of the preconditioner (`surface`), and regrades until the grid fits.
//! 2. `discretise` grades a tensor grid of hexahedra to the patch; on a half-space the outer faces carry the
//!    half-space's own displacements (`far_field`).
//! 3. `contact_set` predicts which nodes touch by projected SOR on the contact forces (`psor`); `constrained_cg` solves
//!    in the subspace that keeps them closed, with a preconditioner that keeps the constraint and balances the load
//!    (after L. Banz and A. Schroeder, Comp. Appl. Math. 2024, doi 10.1007/s40314-024-03066-x). With the feature `gpu` the
//!    corrections within a contact set may come from a graphics processor (`device_cg`).
//! 4. `field` turns nodal forces into pressures and figures, `extrapolation` two or three similar meshes into a peak
//!    pressure with an error; `answer` puts the solution together.
//!
//! ```
//! use std::sync::Arc;
//! use kufe_contact::{Ice, Load, Options, Problem, Runner, Tilt, hertz, solve};
//! use kufe_mesh::Paraboloid;
//!
//! let hull = Paraboloid::new(30.0, 0.005)?;
//! let ice = Ice::half_space(9.0e9, 0.33);
//! let load = Load::central(1000.0, Tilt::Free);
//! let problem = Problem::new(Runner::rigid(Arc::new(hull)), ice, load);
//! let solution = solve(&problem, &Options::default())?;
//! let exact = hertz(30.0, 0.005, 9.0e9 / (1.0 - 0.33 * 0.33), 1000.0);
//! assert!((solution.p_max / exact.p_max - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod beam_space;
mod body;
mod centre_line;
mod check;
mod clamps;
mod constrained_cg;
mod contact_set;
mod corners;
#[cfg(feature = "gpu")]
mod device_cg;
mod discretise;
mod error;
mod extrapolation;
mod far_field;
mod fast_inverse;
mod field;
mod gap;
mod grading;
mod hertz;
mod ice_properties;
mod layered_inverse;
mod level;
mod measure;
mod member;
mod mesh_solve;
mod mortar;
mod motion;
mod mount;
mod options;
mod plain;
mod plain_runner;
mod plane_basis;
mod plane_modes;
mod problem;
mod psor;
mod runner_body;
mod runner_solid;
mod scout;
mod solid_body;
mod solution;
mod solve;
mod stretch;
mod vector;
mod window;

pub use centre_line::{CentreLine, LargestShear, centre_line};
pub use error::Error;
pub use gap::track_height;
pub use hertz::{Hertz, hertz};
pub use ice_properties::{ICE_POISSONS_RATIO, ICE_TEMPERATURES, ice_hardness, ice_youngs_modulus};
pub use mount::{LoadedPlace, Mount, Place};
pub use options::{Method, Options, Watcher};
pub use problem::{Bed, ElasticRunner, Foundation, Ice, Load, Problem, Runner, Tilt};
pub use runner_solid::RunnerSolid;
pub use solution::{Iterate, RunnerField, Solution, SurfaceField, VolumeField};
pub use solve::solve;
