//! What a search tells: its report and the pictures beside it.

pub(crate) mod picture;
pub(crate) mod report;

pub use picture::{Curve, Picture, Plot, Series};
pub use report::{
    Bin, ByRun, ChannelGap, Detectable, Fitted, HeldOut, Interval, NextRuns, OfKind, Report, Rival,
    RunMean, Step, Tolerated, Verdict,
};
