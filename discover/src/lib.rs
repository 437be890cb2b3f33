//! Finds where simulation and measurement disagree, names the missing effect and adds it.
//!
//! | item | purpose |
//! |---|---|
//! | [`runs`] | runs on a track against the one-track model |
//! | [`maps`] | pressure maps against contact solves |
//! | [`experiments`] | friction over pressure and conditions |
//! | [`Report`], [`Verdict`] | what is found |
//! | [`Options`], [`Rules`] | how a search is made: seed, channels; its thresholds |
//!
//! ```no_run
//! use kufe_discover::{Options, runs};
//! let model = kufe_sled::Model::load("model.toml".as_ref())?;
//! let options = Options::default();
//! let data = runs::read("runs.csv".as_ref(), &model, &options)?;
//! let found = runs::search(&data, &model, &options, &|_| {})?;
//! println!("{}", found.report.sentence);
//! # Ok::<(), kufe_discover::Error>(())
//! ```

mod discover;
mod error;
mod evidence;
mod finding;
mod input;
mod joint;
mod null;
mod options;
mod procedure;
mod regression;

pub use discover::discover;
pub use error::Error;
pub use evidence::{experiments, maps, runs};
pub use finding::{
    Baseline, Bin, ByRun, ChannelGap, Curve, Detectable, Fitted, HeldOut, Interval, ModelKind,
    NextRuns, OfKind, Picture, Plot, Remaining, Report, Rival, RunMean, Series, Step, Tolerated,
    Verdict, Withheld,
};
pub use input::{read_map, read_map_bytes};
pub use joint::file::CampaignFile;
pub use null::{MaxT, by_session_permutation, gumbel_tail};
pub use options::Options;
pub use procedure::{
    ExperimentRules, Found, LockRules, MapRules, RivalRule, Rules, RunRules, SearchRules,
};
pub use regression::{Gram, Prior, Scores};
