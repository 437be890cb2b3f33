//! The data of the page of recorded runs.

use std::collections::BTreeSet;

use kufe_sled::{COLUMNS, distinct};
use serde::Serialize;

use crate::jobs::view_runs::{BEHIND, ViewedRuns};
use crate::plot::{shown_unit, sign};
use crate::results::label::name_of;

/// Data of the page of recorded runs.
#[derive(Serialize)]
pub struct RunsPage {
    /// The channels in the order of the page.
    channels: Vec<Channel>,
    #[serde(flatten)]
    viewed: ViewedRuns,
}

/// How a channel is shown.
#[derive(Serialize)]
struct Channel {
    key: String,
    label: String,
    unit: String,
    /// Number of display units in one unit of the column.
    times: f64,
}

/// Channels that are listed first, as the most relevant for drivers.
const FIRST: [&str; 6] = [
    "v_mps",
    "delta_rad",
    "alpha_rad",
    "yaw_rate_radps",
    "ay_mps2",
    "az_mps2",
];

impl RunsPage {
    /// Largest number of values of a page of 15 MB: 16 bits each, in base64.
    pub const MAX_VALUES: usize = 5_500_000;

    /// The data of the page of these runs.
    pub fn new(viewed: ViewedRuns) -> RunsPage {
        let runs = viewed.runs.iter();
        let keys = runs.flat_map(|run| run.columns.keys().chain(run.model.keys()));
        let present: BTreeSet<&str> = keys.map(String::as_str).collect();
        let known = FIRST.into_iter().chain(COLUMNS).chain([BEHIND]);
        let known = known.filter(|key| present.contains(key));
        let keys = distinct(known.chain(present.iter().copied()));
        RunsPage {
            channels: keys.into_iter().map(channel).collect(),
            viewed,
        }
    }
}

/// Label and unit; angles in degrees, as charts show them.
fn channel(key: &str) -> Channel {
    let degrees = f64::to_degrees(1.0);
    let (unit, times) = match &*shown_unit(key) {
        "rad" => ("°".to_owned(), degrees),
        "rad/s" => ("°/s".to_owned(), degrees),
        unit => (sign(unit), 1.0),
    };
    let label = match key {
        BEHIND => "run behind model".to_owned(),
        key => name_of(key),
    };
    Channel {
        key: key.to_owned(),
        label,
        unit,
        times,
    }
}
