//! Lookup tables of contact figures over normal force and track curvature.
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
//! | [`sweep`] | fills a [`Plan`] from a solver's answers |
//! | [`curvature_from_pitch`] | the input that a sled measures |

mod axes;
mod csv_file;
mod each;
mod error;
mod flush;
mod fmu;
mod grid;
mod header;
mod lookup;
mod mat_file;
mod picture;
mod pitch;
mod quantity;
mod read;
mod refine;
mod script;
mod shard;
mod smooth;
mod store;
mod sweep;
mod table;
mod write;

pub use axes::{Axes, MAX_AXIS, MAX_NODES};
pub use error::Error;
pub use flush::Flush;
pub use lookup::{Looked, Lookup, Mode};
pub use picture::draw;
pub use pitch::{MIN_SPEED, curvature_from_pitch, radius_from_pitch};
pub use quantity::{Point, Quantity, Solved};
pub use read::MAX_FILE_BYTES;
pub use script::{parallel as parallel_script, slurm as slurm_script};
pub use shard::{Done, Manifest, Next, next_batch, solve_missing};
pub use store::{Origin, Store, sha256};
pub use sweep::{Plan, Spacing, SweepError, Swept, sweep, sweep_batches};
pub use table::{Check, Measured, Table};
