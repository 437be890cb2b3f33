//! Lookup tables of contact figures over normal force and track curvature, of a sliding runner also
//! over speed and ice temperature.
//!
//! A simulator cannot solve a contact at every step: it interpolates the pressure in a table. This
//! crate defines such a table, evaluates it, places its points and writes it in the forms that
//! simulators read. It never solves a contact itself: the solver is given as a closure.
//!
//! | item | what it is |
//! |---|---|
//! | [`Table`] | nodes, checks between them, and their origin; reads and writes `.lut` files |
//! | [`Axes`], [`CurvatureScaling`] | the breakpoints; curvatures relative to that at which the runner lies flush |
//! | [`Interpolator`] | one quantity, ready for evaluation in a [`Mode`] |
//! | [`sweep`] | fills a [`Plan`] from a solver's answers |
//! | [`curvature_from_pitch`] | the input that a sled measures |

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
    Fmi, Fmu, MatValue, OCTAVE_FUNCTION, binding_files, parallel_script, read_fmu, simulink_files,
    slurm_script, write_mat_file,
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
