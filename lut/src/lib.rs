//! Lookup tables of contact figures as functions of normal force and track curvature, and for a
//! sliding runner of speed and ice temperature.
//!
//! A simulator cannot solve a contact at every step, so that it interpolates the pressure in a
//! table. This crate defines such a table, evaluates it, places its points and writes it in the
//! formats of simulators. The solver is given as a closure.
//!
//! | item | purpose |
//! |---|---|
//! | [`Table`] | nodes, checks between them, and the origin of both; reads and writes `.lut` files |
//! | [`Axes`], [`CurvatureScaling`] | the breakpoints; curvatures relative to the curvature at which the runner lies flush |
//! | [`Interpolator`] | one quantity, ready for evaluation in a [`Mode`] |
//! | [`sweep`] | makes the table of a [`Plan`] with a solver |
//! | [`curvature_from_pitch`] | track curvature from measured speed and pitch rate |

mod axes;
mod error;
mod export;
mod file;
mod interpolator;
mod monotone;
mod pitch;
mod quantity;
mod reduced;
mod solve;
mod sweep;
mod table;
mod unit;

pub use axes::{Axes, AxisKind, MAX_NODES, Outside, Point};
pub use error::Error;
pub use export::{
    Fmi, Fmu, MatValue, OCTAVE_FUNCTION, binding_files, parallel_script, read_fmu, shell_word,
    simulink_files, slurm_script, write_mat_file,
};
pub use file::MAX_FILE_BYTES;
pub use interpolator::{Interpolated, Interpolator, Mode};
pub use pitch::{MIN_SPEED, curvature_from_pitch};
pub use quantity::{Figures, Method, Quantity};
pub use reduced::CurvatureScaling;
pub use solve::Solve;
pub use sweep::{Plan, Progress, Spacing, SweepError, SweepResult, each, replay, sweep};
pub use table::{InterpolationError, Origin, Table, check_finite};
pub use unit::unit_of;
