//! Frictionless contact of a runner on ice.
//!
//! | type | what it is |
//! |---|---|
//! | [`Problem`] | runner, ice, track and load |
//! | [`Options`] | accuracy and limits |
//! | [`solve`] | problem in, solution out |
//! | [`Solution`] | pressure field, figures, history |
//! | [`runner_loads()`], [`RunnerLoads`] | stresses in an elastic runner and the forces on its mounts |
//! | [`slide`], [`SlidingSolution`], [`Groove`] | sliding on ice that yields: groove, ploughing force |
//! | [`boundary_elements()`], [`BoundaryElements`] | the contact solved independently by boundary elements, where they apply |
//! | [`VerifiedBem`] | boundary elements for a family of contacts, verified at its ends by finite elements |
//! | [`hertz`] | the closed form of smooth point contacts |
//!
//! The folders are the steps of a solve. Each imports only from the folders above it.
//!
//! 1. `problem`: the problem, its checks, and the undeformed gap.
//! 2. `grid`: the patch in contact, guessed from the gap, and the axes graded to it.
//! 3. `precondition`: approximate inverses of the stiffness on tensor grids.
//! 4. `bodies`: the ice and the runner. On a half-space the outer faces have the half-space's own
//!    displacements (`far_field`).
//! 5. `green`: the Green's matrix of the contact plane.
//! 6. `mesh`: one mesh of both bodies (`discretise`) and the contact on it (`contact_mesh`).
//! 7. `active_set`: projected SOR with minimisation on the active set (L. Banz and A. Schroeder,
//!    Comp. Appl. Math. 2024, doi 10.1007/s40314-024-03066-x). Sweeps over the contact forces find
//!    the contact set (`plane_problem`); an acceleration solves on that set (`constrained_cg`).
//! 8. `result`: pressures and figures from nodal forces.
//! 9. `accuracy`: `find_patch` finds the patch with contact problems on the plane alone; `meshes`
//!    refines; `estimators` extrapolates the figures of several meshes to limits, with errors.
//! 10. `map`: the solution on the pixels of a regular grid.
//! 11. `boundary_elements`: a second method, on the contact plane alone; the only one for contacts
//!     of many asperities (`asperities`).
//! 12. `groove`: steady sliding on ice that yields.
//!
//! The iteration minimises the complementary energy of the contact forces, D(f) = 1/2 f^T S f + g^T
//! f, with S the compliance of the bodies and g the gap without forces. The forces lie between 0
//! and the hardness of the ice times the area of their node, and balance the load and its moments.
//! The minimum of D is minus the total potential energy, which includes the work of the load.
//!
//! Sweeps are projected onto bounds and balance together (`balance`), with the step length that
//! minimises D. An acceleration is accepted where D falls; otherwise it ends where the first force
//! meets its bound, or sweeps follow. On the contact plane no set's minimiser occurs twice, so the
//! iteration ends from any start. On the bodies this holds if the equations of each set are solved
//! exactly; their solution is stopped as soon as signs contradict the set, with D known to the
//! residual. [`Solution::history`] has sweeps, accelerations and energies.
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
//! let exact = hertz(30.0, 0.005, 9.0e9 / (1.0 - 0.33 * 0.33), 1000.0)?;
//! assert!((solution.p_max / exact.p_max - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accuracy;
mod active_set;
mod bisection;
mod bodies;
mod boundary_elements;
mod closed_forms;
mod error;
mod green;
mod grid;
mod groove;
mod map;
mod mesh;
mod motion;
mod options;
mod precondition;
mod problem;
mod result;
mod solve;
mod symmetry;
mod vector;

pub use boundary_elements::check::{
    BoundaryElements, VerifiedBem, boundary_elements, boundary_elements_to,
    boundary_elements_to_compare,
};
pub use boundary_elements::window::CheckUnavailable;
pub use closed_forms::{Hertz, hertz};
pub use error::Error;
pub use groove::sequence::slide;
pub use groove::solution::{
    Coarser, Groove, GrooveProfile, Section, SlidingIterate, SlidingMesh, SlidingSolution,
};
pub use map::pressure_map::{PressureMap, parted, pressure_maps};
pub use map::rim::squared_pressure;
pub use mesh::assembled::AssembledBody;
pub use options::{
    MeshWatcher, NUMERICS, NextMesh, Options, SlidingWatcher, StiffnessForm, Watcher,
};
pub use problem::contact_problem::{ElasticRunner, Load, Problem, Runner, Tilt};
pub use problem::gap::track_height;
pub use problem::ice::{
    Bed, Foundation, ICE_POISSONS_RATIO, Ice, ice_hardness, ice_melting_pressure,
    ice_youngs_modulus,
};
pub use problem::mount::{LoadedPlace, Mount, Place};
pub use problem::runner_solid::RunnerSolid;
pub use result::asperity::Asperity;
pub use result::centre_line::{CentreLine, LargestShear, UnderPeak, centre_line};
pub use result::runner_loads::{MountForce, RunnerLoads, runner_loads};
pub use result::solution::{Iterate, Measure, RunnerField, Solution, SurfaceField, VolumeField};
pub use solve::{check_problem, solve};
