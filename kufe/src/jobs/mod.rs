//! Jobs: what the command and the Python package do alike, from files to results.
//!
//! A job takes the paths that a user gives, calls the libraries, and fails with the one sentence
//! that the user reads. It prints nothing: progress and warnings go to closures. Which files are
//! written is the caller's to say.
//!
//! | item | the job |
//! |---|---|
//! | [`case_file::LoadedCase`], [`Contact`] | a case and its solution, with what there is to say about it |
//! | [`field`] | the maps, pictures and bodies of a solved contact, as files |
//! | [`slide`] | a case's groove, melt film and friction, and friction over speed and temperature |
//! | [`table`] | a table file and the lookup table that it specifies |
//! | [`runs`] | recorded runs, chosen and prepared |
//! | [`Failure`] | how a job fails: in a sentence, of one of four kinds |
//! | [`Watch`] | who receives progress and warnings, and may stop the job |
//!
//! ```
//! use kufe::jobs::{Contact, case_file::LoadedCase};
//! let solved = Contact::from(LoadedCase::example()?).solve()?;
//! assert!((solved.solution.p_max / 138.5e6 - 1.0).abs() < 0.01);
//! # Ok::<(), kufe::jobs::Failure>(())
//! ```

pub mod case_file;
mod case_json;
mod document_mat;
pub mod failure;
pub mod field;
mod press;
pub mod runs;
pub mod slide;
pub mod table;
mod watch;
mod write_whole;

pub use case_json::{case_json, json_number, toml_json};
pub use document_mat::write_document_mat;
pub use failure::Failure;
pub use press::{
    Contact, Prepared, SolvedContact, newtons, percent, press_prepared, time_left, with_progress,
};
pub use watch::Watch;
pub use write_whole::write_whole;

/// A commented `table.toml` to start from; its case is `case.toml` in the same folder.
pub const TABLE_EXAMPLE: &str = include_str!("../../assets/table.toml");
/// A commented `model.toml` to start from: the published sled.
pub const MODEL_EXAMPLE: &str = include_str!("../../assets/model.toml");
