//! Frictionless contact of a runner on ice.
//!
//! | type | what it is |
//! |---|---|
//! | [`Problem`] | runner, ice, track and load |
//! | [`Options`] | accuracy and limits |
//! | [`solve`] | problem in, solution out |
//! | [`Solution`] | pressure field, figures, history |
//! | [`runner_loads()`], [`RunnerLoads`] | what an elastic runner bears, and what it pushes its mounts with |
//! | [`slide`], [`SlidingSolution`], [`Groove`] | a runner that slides on ice that yields: groove, ploughing force |
//! | [`boundary_elements()`], [`BoundaryElements`] | a second answer by another method, where it applies |
//! | [`Anchored`] | boundary elements for a family of contacts, confirmed at its ends by finite elements |
//! | [`hertz`], [`rigid_plastic`] | closed forms for smooth point contacts, and for grooves in ice that does not spring back |
//!
//! How a problem becomes a pressure, room by room:
//!
//! 1. `problem`: what is asked, checked, and the undeformed gap.
//! 2. `grid`: `first_guess` guesses the patch from that gap, `discretise` grades a tensor grid of hexahedra to it.
//! 3. `bodies`, `precondition`: the ice and the runner, with cheap inverses of their stiffness; on a half-space the outer
//!    faces carry the half-space's own displacements (`far_field`).
//! 4. `active_set`: accelerated projective SOR (after L. Banz and A. Schroeder, Comp. Appl. Math. 2024, doi
//!    10.1007/s40314-024-03066-x). Sweeps over the contact forces find which nodes touch (`plane_problem`, with the Green's
//!    matrix of the preconditioner); an acceleration solves on that set (`constrained_cg`: conjugate gradients that keep the
//!    nodes closed and the load balanced).
//! 5. `accuracy`: `scout` finds the patch with contact problems on the contact plane alone, whose matrix is the Green's
//!    matrix of the preconditioner (`plane_basis`); `order` and `extrapolation` make three similar meshes into figures
//!    with errors.
//! 6. `result`: `pressure` turns nodal forces into pressures and figures, `answer` puts the solution together.
//! 7. `map`: the solution on the pixels of a regular grid, as files and pages show it.
//! 8. `groove`: steady sliding on ice that yields, on the rooms above.
//! 9. `boundary_elements`: a second method on the contact plane alone, which shares the problem's gap and nothing else.
//! 10. `reference`: closed forms and plain methods to compare with.
//!
//! What falls is the complementary energy of the contact forces, D(f) = 1/2 f^T S f + g^T f with S the bodies' response and g
//! the gap without forces, over forces between 0 and what the ice bears that balance the load and its moments; its least
//! value is minus the total potential energy, the load's work in it. Sweeps are projected onto bounds and balance together
//! (`balance`) and go as far as D falls; an acceleration is accepted where D falls, and otherwise ends where the first
//! force meets its bound, or sweeps go on. On the contact plane no set's minimiser can be met twice, so it ends from wherever
//! it begins. On the bodies themselves the same holds where the equations of each set are solved exactly; they are left
//! as soon as signs contradict the set, with D known to the residual. [`Solution::history`] tells sweeps, accelerations
//! and energies.
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
mod anchored;
mod bodies;
mod boundary_elements;
mod error;
mod green;
mod grid;
mod groove;
mod map;
mod options;
mod precondition;
mod problem;
mod reference;
mod result;
mod solve;

pub use anchored::Anchored;
pub use boundary_elements::{
    BoundaryElements, NotChecked, boundary_elements, boundary_elements_to,
    boundary_elements_to_compare,
};
pub use error::Error;
pub use groove::profile::GrooveProfile;
pub use groove::slide::slide;
pub use groove::solution::{Groove, Measure, Section, SlidingMesh, SlidingSolution};
pub use map::patches::{parted, pressure_maps};
pub use map::pressure_map::PressureMap;
pub use map::rim::squared_pressure;
pub use options::{MeshWatcher, Method, NUMERICS, NextMesh, Options, StiffnessForm, Watcher};
pub use problem::contact_problem::Problem;
pub use problem::gap::track_height;
pub use problem::ice::{Bed, Foundation, Ice};
pub use problem::ice_properties::{
    ICE_POISSONS_RATIO, ICE_TEMPERATURES, ice_hardness, ice_melting_pressure, ice_youngs_modulus,
};
pub use problem::load::{Load, Tilt};
pub use problem::mount::{LoadedPlace, Mount, Place};
pub use problem::runner::{ElasticRunner, Runner};
pub use problem::runner_solid::RunnerSolid;
pub use reference::hertz::{Hertz, hertz};
pub use reference::rigid_plastic::{RigidPlastic, rigid_plastic};
pub use result::centre_line::{CentreLine, LargestShear, UnderPeak};
pub use result::column_stress::centre_line;
pub use result::runner_loads::{MountForce, RunnerLoads, runner_loads};
pub use result::solution::{
    AssembledBody, Iterate, RunnerField, Solution, SurfaceField, VolumeField,
};
pub use solve::{check_problem, solve};
