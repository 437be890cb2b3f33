//! Lookup tables of contact figures over normal force and track curvature, of a sliding runner also over speed and temperature of the ice.
//!
//! A simulator cannot solve a contact at every step: it looks the pressure up. This crate holds such a table,
//! evaluates it, places its points and writes it in the forms that simulators read. It never solves a
//! contact itself: the solver comes in as a closure.
//!
//! | item | what it is |
//! |---|---|
//! | [`Table`] | nodes, checks between them, and where they come from; reads and writes `.lut` files |
//! | [`Axes`], [`Flush`] | the breakpoints; curvatures as seen from where the runner lies flush |
//! | [`Lookup`] | one quantity, ready for evaluation in a [`Mode`] |
//! | [`Layered`] | the same of a runner that slides, over speed and temperature of the ice too |
//! | [`sweep`] | fills a [`Plan`] from a solver's answers |
//! | [`curvature_from_pitch`] | the input that a sled measures |

mod error;
mod export;
mod file;
mod store;
mod sweep;
mod table;
mod unit;

pub use error::Error;
pub use export::{Fmu, MatValue, Sample, read_fmu, simulink_files, write_mat_file};
pub use file::MAX_FILE_BYTES;
pub use store::{
    Done, Manifest, Next, Origin, Store, next_batch, parallel_script, sha256, slurm_script,
    solve_missing,
};
pub use sweep::{Plan, Spacing, SweepError, Swept, each, sweep, sweep_batches};
pub use table::{
    Axes, Check, Errors, Flush, Layered, Looked, Lookup, MAX_AXIS, MAX_NODES, MIN_SPEED, Measured,
    Method, Mode, Point, Quantity, Sliding, Solved, Table, curvature_from_pitch, radius_from_pitch,
};
pub use unit::unit_of;
