//! The tables of a case, key by key as they stand in the file.

mod accuracy;
mod hardness;
mod ice;
mod load;
mod mount;
mod runner;
mod section;
mod shape;
mod solver;
mod thickness;
mod track;
mod word_or_number;

pub use accuracy::AccuracyTable;
pub use hardness::Hardness;
pub use ice::{BedTable, IceTable, WavinessTable};
pub use load::{LoadTable, TiltWord};
pub(crate) use mount::mesh_error;
pub use mount::{CarriesTable, HeldTable, MountTable};
pub use runner::{ForwardAxis, RunnerTable, UpAxis};
pub use section::SectionTable;
pub use shape::Shape;
pub use solver::{SolverTable, StiffnessWord};
pub use thickness::Thickness;
pub use track::TrackTable;
