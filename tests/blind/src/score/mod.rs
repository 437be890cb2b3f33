//! Runs the finder on cases and compares its reports with the answers.

pub mod ci;
pub mod constants;
mod fresh;
mod judge;
mod open_table;
mod outcome;
mod run;
pub mod table;

pub use judge::judge;
pub use open_table::{is_worse, open_table, wilson};
pub use outcome::{Claim, Found, Fresh, OnRun, Outcome};
pub use run::{Options, score};
