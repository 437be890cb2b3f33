//! What a search tells: its report and the pictures beside it.

pub(crate) mod next_runs;
pub(crate) mod picture;
pub(crate) mod report;

pub use next_runs::NextRuns;
pub use picture::{Curve, Picture, Plot, Series};
pub use report::{
    Baseline, Bin, ByRun, ChannelGap, Detectable, Fitted, HeldOut, Interval, ModelKind, OfKind,
    Remaining, Report, Rival, RunMean, Step, Tolerated, Verdict, Withheld,
};
