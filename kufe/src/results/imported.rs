//! The document of imported runs.

use std::collections::BTreeMap;

use kufe_telemetry::{ExcludedRun, Note};
use serde::Serialize;

/// `import.json`: what was imported.
#[derive(Clone, Debug, Serialize)]
pub struct ImportList {
    /// The mapping's file.
    pub mapping: String,
    /// Version of the program.
    pub version: String,
    /// Files of the folder.
    pub files: Vec<String>,
    /// Run by run.
    pub runs: Vec<ImportedRun>,
    /// Runs that are not imported, with the reason.
    pub excluded: Vec<ExcludedRun>,
}

/// One imported run.
#[derive(Clone, Debug, Serialize)]
pub struct ImportedRun {
    /// Its name.
    pub run: String,
    /// Its length [s].
    pub seconds: f64,
    /// Samples by channel.
    pub samples: BTreeMap<String, SampleCount>,
    /// Rows without a value by channel.
    pub missing_rows: BTreeMap<String, usize>,
    /// Delays that were found by logger.
    pub delays: BTreeMap<String, FoundDelay>,
    /// What else was noticed.
    pub remarks: Vec<String>,
}

/// Samples of a channel.
#[derive(Clone, Debug, Serialize)]
pub struct SampleCount {
    /// Those that its rate makes.
    pub expected: usize,
    /// Those with a value.
    pub read: usize,
}

/// The delay of a logger's clock.
#[derive(Clone, Debug, Serialize)]
pub struct FoundDelay {
    /// Delay [s].
    pub delay_s: f64,
    /// Its standard error [s].
    pub delay_sd_s: Option<f64>,
    /// What else the delay contains.
    pub delay_includes: Option<&'static str>,
}

impl ImportedRun {
    /// Of a run that was made so.
    pub fn of(note: &Note) -> ImportedRun {
        let channels = || note.channels.iter();
        let missing = channels().filter(|(_, channel)| channel.missing_rows > 0);
        let found = note
            .loggers
            .iter()
            .filter(|(_, logger)| logger.clock.source == "found");
        ImportedRun {
            run: note.run.clone(),
            seconds: note.rows as f64 / note.rate_hz,
            samples: channels()
                .map(|(name, channel)| {
                    let count = SampleCount {
                        expected: channel.expected_samples,
                        read: channel.samples,
                    };
                    (name.clone(), count)
                })
                .collect(),
            missing_rows: missing
                .map(|(name, channel)| (name.clone(), channel.missing_rows))
                .collect(),
            delays: found
                .map(|(name, logger)| {
                    let delay = FoundDelay {
                        delay_s: logger.clock.delay_s,
                        delay_sd_s: logger.clock.delay_sd_s,
                        delay_includes: logger.clock.delay_includes,
                    };
                    (name.clone(), delay)
                })
                .collect(),
            remarks: note.remarks.clone(),
        }
    }
}
