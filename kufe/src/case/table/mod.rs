//! The tables of a case, key by key as in the file.

mod accuracy;
mod ice;
mod load;
mod mount;
mod runner;
mod section;
mod shape;
mod sliding;
mod solver;
mod track;
mod words;

pub use accuracy::AccuracyTable;
pub use ice::{BedTable, IceTable, WavinessTable};
pub use load::{LoadTable, TiltWord};
pub(crate) use mount::mesh_error;
pub use mount::{CarriesTable, HeldTable, MountTable};
pub use runner::{FileAxis, RunnerTable};
pub use section::SectionTable;
pub use shape::Shape;
pub use sliding::{HardnessTable, SlidingTable};
pub use solver::{SolverTable, StiffnessWord};
pub use track::TrackTable;
pub use words::{Hardness, Thickness};
