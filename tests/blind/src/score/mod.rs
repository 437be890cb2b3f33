//! The finder on cases, and its reports held against the answers.

pub mod ci;
mod judge;
mod outcome;
mod run;
pub mod table;

pub use judge::judge;
pub use outcome::{Claim, Found, Outcome};
pub use run::{Options, score};
