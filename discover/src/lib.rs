//! Finds where simulation and measurement disagree, names the missing effect and adds it.
//!
//! | item | purpose |
//! |---|---|
//! | [`runs`] | runs on a track against the one-track model |
//! | [`pressures`] | pressure maps against contact solves |
//! | [`experiments`] | friction over pressure and conditions |
//! | [`Report`], [`Verdict`] | what is found |
//! | [`Options`] | seed, number of twins and sign-flips, channels |
//!
//! ```no_run
//! use kufe_discover::{Options, runs};
//! let model = kufe_sled::Model::load("model.toml".as_ref())?;
//! let data = runs::read("runs.csv".as_ref(), &model)?;
//! let found = runs::search(&data, &model, &Options::default(), &|_| {})?;
//! println!("{}", found.report.sentence);
//! # Ok::<(), kufe_discover::Error>(())
//! ```

mod closed;
mod dispatch;
mod error;
pub mod experiments;
mod exr_map;
mod flips;
mod html;
mod plot;
pub mod pressures;
mod random;
mod report;
pub mod runs;
mod score;
mod sentence;
mod smooth;
mod table;

pub use dispatch::discover;
pub use error::Error;
pub use exr_map::{read_map, read_map_bytes};
pub use flips::{MaxT, by_session_permutation, gumbel_tail};
pub use html::page;
pub use report::{
    Bin, ChannelGap, Detectable, Fitted, HeldOut, Interval, Picture, Report, Rival, Step, Verdict,
};
pub use score::{Gram, Scores};

/// How a search is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Twins a look.
    pub twins: u64,
    /// Sign-flips a look.
    pub flips: usize,
    /// Whether the longitudinal channel of runs takes part.
    pub longitudinal: bool,
    /// Whether the lateral channels of runs take part.
    pub lateral: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            twins: 40,
            flips: 1999,
            longitudinal: true,
            lateral: true,
        }
    }
}
