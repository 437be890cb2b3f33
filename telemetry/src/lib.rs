//! Import of recordings of other programs as runs.
//!
//! | item | purpose |
//! |---|---|
//! | [`Mapping`], [`plan`] | `mapping.toml`, and the runs with the files that it names |
//! | [`read_log`], [`read_text`] | a recording: text below any head, Parquet, MATLAB |
//! | [`conversion`], [`column_unit`] | units as loggers write them, in those of kufe's columns |
//! | [`resample()`] | a series at uniform times, without values in gaps |
//! | [`Importer`] | import of one run with a common clock and rate, and the [`Note`] of its steps |
//! | [`guess_mapping`] | a commented mapping guessed from samples, with open questions |
//!
//! ```
//! use kufe_telemetry::Mapping;
//! let mapping = Mapping::parse(
//!     "[logger.box]\n\
//!      files = \"raw/*.csv\"\n\
//!      time = \"Time\"\n\
//!      [channels]\n\
//!      ay_mps2 = { from = \"Lateral Acc\", unit = \"g\", sign = -1 }\n",
//!     "mapping.toml",
//! )?;
//! assert_eq!(mapping.rate_hz, 100.0);
//! # Ok::<(), kufe_telemetry::Error>(())
//! ```

mod delay;
mod error;
mod guess;
mod import;
mod log;
mod mapping;
mod mdf4;
mod plan;
mod recording;
mod relation;
mod resample;
mod text;
mod unit;

pub use delay::LoggerClock;
pub use error::Error;
pub use guess::guess_mapping;
pub use import::{ChannelNote, Imported, Importer, LoggerNote, Note, Recipe, model_fragment};
pub use log::{Channel, Log};
pub use mapping::{ChannelSource, ClockWord, IndexValues, LoggerFiles, Mapping, PlannedRun};
pub use mdf4::read_mdf4;
pub use plan::{ExcludedRun, Plan, index_csv, plan};
pub use recording::{read_log, read_matlab73};
pub use relation::Relation;
pub use resample::{Base, Gap, Resampled, resample};
pub use text::{TextOptions, read_text};
pub use unit::{Conversion, column_unit, conversion};

/// A commented `mapping.toml` to start from.
pub const MAPPING_EXAMPLE: &str = include_str!("../assets/mapping.toml");
