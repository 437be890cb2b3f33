//! Jobs: the work shared by the command and the Python package, from files to results.
//!
//! A job takes the paths that a user gives, calls the libraries, and fails with the one sentence
//! that the user reads. It prints nothing: progress and warnings go to closures. Which files are
//! written is up to the caller.
//!
//! | item | the job |
//! |---|---|
//! | [`case_file::LoadedCase`], [`Contact`] | a case and its solution, with its warnings |
//! | [`Step`] | one contact of a series |
//! | [`field`], [`export`], [`CaseMeshes`] | the maps, pictures and bodies of a case, as files |
//! | [`check_hull`] | whether a scanned hull can be pressed |
//! | [`FrictionLaw`] | friction of a contact by a law over its pressure |
//! | [`slide`] | a case's groove, melt film and friction, and friction over speed and temperature |
//! | [`table`] | a table file and the lookup table that it specifies |
//! | [`import`] | recordings of other programs become runs |
//! | [`runs`], [`gather`], [`align`], [`view_runs`] | recorded runs, selected and prepared, gathered, aligned, shown |
//! | [`lateral`], [`simulate`], [`replay`] | lateral friction fitted to runs and compared with them; simulated runs; a run that the model drives again |
//!
//! ```
//! use kufe::jobs::{Contact, case_file::LoadedCase};
//! let solved = Contact::from(LoadedCase::example()?).solve()?;
//! assert!((solved.solution.p_max / 138.5e6 - 1.0).abs() < 0.01);
//! # Ok::<(), kufe::jobs::Failure>(())
//! ```

pub mod align;
pub mod case_file;
mod document_mat;
pub mod export;
pub mod failure;
pub mod field;
pub mod gather;
mod hull_check;
pub mod import;
pub mod lateral;
mod law_friction;
mod meshes;
mod press;
pub mod replay;
pub mod runs;
mod series;
pub mod simulate;
pub mod slide;
pub mod table;
pub mod view_runs;
mod watch;

pub use document_mat::{
    Columns, channel_series, force_columns, force_series, run_columns, write_document_mat,
};
pub use failure::{Failure, Located, write_whole};
pub use hull_check::{ExaminedHull, check_hull};
pub use law_friction::{DrivingConditions, FrictionLaw};
pub use meshes::{CaseMeshes, write_mesh_quality};
pub use press::{Contact, Prepared, SolvedContact, press_prepared, time_left, with_progress};
pub use series::Step;
pub use watch::Watch;

/// A commented `table.toml` to start from; its case is `case.toml` in the same folder.
pub const TABLE_EXAMPLE: &str = include_str!("../../assets/table.toml");
