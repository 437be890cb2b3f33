//! What was done to make a run, `RUN.import.json`.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::clock::Relation;

/// Most gaps of a channel that a note lists; further ones are counted.
pub(crate) const LISTED_GAPS: usize = 200;

/// How a run was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Note {
    /// The run.
    pub run: String,
    /// The mapping's file.
    pub mapping: String,
    /// SHA-256 of the mapping.
    pub mapping_sha256: String,
    /// Version of kufe that made it.
    pub version: &'static str,
    /// Rate of the run [Hz].
    pub rate_hz: f64,
    /// Number of rows.
    pub rows: usize,
    /// What the clock of the runs says at `t_s` = 0 [s].
    pub start_s: f64,
    /// The logger whose clock that is.
    pub clock: String,
    /// The recordings.
    pub loggers: BTreeMap<String, LoggerNote>,
    /// The columns.
    pub channels: BTreeMap<String, ChannelNote>,
    /// Mass of the sled with its crew [kg], where it is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// What was odd.
    pub remarks: Vec<String>,
}

/// What was done with a logger's file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoggerNote {
    /// The file.
    pub file: String,
    /// Its SHA-256.
    pub sha256: String,
    /// Whose its clock is: "the runs'", "shared", "stated" or "found".
    pub clock: &'static str,
    /// By how much it is late: an event stands in it this much later than in the runs' clock [s].
    pub delay_s: f64,
    /// Standard error of that [s], where it was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_sd_s: Option<f64>,
    /// What else than its clock the delay found holds, of which the error says nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_includes: Option<&'static str>,
    /// What it was found from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub relations: Vec<Relation>,
}

/// What was done with a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelNote {
    /// The logger.
    pub logger: String,
    /// The channel's name there.
    pub from: String,
    /// Its unit there.
    pub unit: String,
    /// Who says so: "mapping" or "file".
    pub unit_from: &'static str,
    /// `column = factor * value + offset`, all told.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
    /// 1 or -1; `factor` has it.
    pub sign: f64,
    /// By how much the channel is late beside its logger's clock, as stated [s].
    pub delay_s: f64,
    /// The sensor's place from the centre of gravity [m], where it is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place_m: Option<[f64; 3]>,
    /// Its own rate [Hz].
    pub rate_hz: f64,
    /// Largest deviation of its times from uniform ones [steps].
    pub jitter_steps: f64,
    /// Corner of the low pass before it was thinned out [Hz]; none where it is no faster than the run.
    pub filter_hz: Option<f64>,
    /// Whether rows stand between its samples.
    pub interpolated: bool,
    /// Rows without a value.
    pub missing_rows: usize,
    /// How many gaps they make.
    pub gap_count: usize,
    /// The first of them: from and to [s].
    pub gaps_s: Vec<[f64; 2]>,
}
