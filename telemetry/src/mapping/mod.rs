//! Which files the runs are in, and what their channels are called.

mod check;
mod file;
mod index;
mod parse;
mod plan;
mod runs_csv;

pub use file::{
    ChannelSource, ClockWord, IndexValues, LoggerFiles, Mapping, RunFormatWord, RunTable,
};
pub(crate) use index::index_help;
pub use plan::{PlannedRun, plan};
pub use runs_csv::index_csv;
