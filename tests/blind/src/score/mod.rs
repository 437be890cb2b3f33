//! The finder on cases, and its reports held against the answers.

pub mod ci;
pub mod constants;
mod judge;
mod outcome;
mod run;
pub mod table;

pub use judge::judge;
pub use outcome::{Claim, Found, Outcome};
pub use run::{Options, score};
