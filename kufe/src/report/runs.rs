//! The data of the page of recorded runs.

use std::collections::{BTreeMap, BTreeSet};

use kufe_sled::{COLUMNS, Fault, Note, OddStretch, Section, distinct};
use serde::Serialize;

use crate::jobs::gather::UNNAMED;
use crate::jobs::view_runs::{BEHIND, ViewedRun, ViewedRuns};
use crate::report::pack::{Packed, pack};
use crate::report::results::label::{name_of, unit_of};
use crate::report::sign::sign;

/// Data of the page of recorded runs.
#[derive(Serialize)]
pub struct RunsPage {
    /// Index of the runs.
    index: String,
    /// Largest rate of the channels [Hz].
    rate_hz: f64,
    /// The model's file.
    model: Option<String>,
    /// The channels in the order of the page.
    channels: Vec<Channel>,
    runs: Vec<PackedRun>,
    /// Names and reasons.
    left_out: Vec<[String; 2]>,
}

/// How a channel is shown.
#[derive(Serialize)]
struct Channel {
    key: String,
    label: String,
    unit: String,
    /// Shown units in one of the column.
    times: f64,
}

/// A run with its channels packed.
#[derive(Serialize)]
struct PackedRun {
    run: String,
    track: Option<String>,
    driver: Option<String>,
    session: Option<String>,
    t0_s: f64,
    rate_hz: f64,
    columns: BTreeMap<String, Packed>,
    model: BTreeMap<String, Packed>,
    stretches: Vec<OddStretch>,
    sections: Vec<Section>,
    contacts: Vec<[f64; 2]>,
    faults: Vec<Fault>,
    notes: Vec<Note>,
}

/// Channels that come first: what a driver reads.
const FIRST: [&str; 6] = [
    "v_mps",
    "delta_rad",
    "alpha_rad",
    "yaw_rate_radps",
    "ay_mps2",
    "az_mps2",
];

impl RunsPage {
    /// Most values of a page of 15 MB: of 16 bits each, in base64.
    pub const MOST_VALUES: usize = 5_500_000;

    /// Of the runs with these channels.
    pub fn new(viewed: ViewedRuns) -> RunsPage {
        let runs = viewed.runs.iter();
        let keys = runs.flat_map(|run| run.columns.keys().chain(run.model.keys()));
        let there: BTreeSet<&str> = keys.map(String::as_str).collect();
        let known = FIRST.into_iter().chain(COLUMNS).chain([BEHIND]);
        let known = known.filter(|key| there.contains(key));
        let keys = distinct(known.chain(there.iter().copied()));
        RunsPage {
            channels: keys.into_iter().map(channel).collect(),
            index: viewed.index,
            rate_hz: viewed.rate_hz,
            model: viewed.model,
            runs: viewed.runs.into_iter().map(packed).collect(),
            left_out: viewed.left_out,
        }
    }
}

/// Label and unit; angles in degrees, as charts show them.
fn channel(key: &str) -> Channel {
    let degrees = f64::to_degrees(1.0);
    let (unit, times) = match &*unit_of(key) {
        "rad" => ("°".to_owned(), degrees),
        "rad/s" => ("°/s".to_owned(), degrees),
        unit => (sign(unit), 1.0),
    };
    let is_behind = key == BEHIND;
    Channel {
        key: key.to_owned(),
        label: if is_behind {
            "run behind model".to_owned()
        } else {
            name_of(key)
        },
        unit,
        times,
    }
}

fn packed(run: ViewedRun) -> PackedRun {
    let stated = |name: String| (name != UNNAMED).then_some(name);
    let pack_all = |columns: BTreeMap<String, Vec<f64>>| {
        let columns = columns.into_iter();
        columns.map(|(name, values)| (name, pack(values))).collect()
    };
    PackedRun {
        run: run.entry.run,
        track: stated(run.entry.track),
        driver: stated(run.entry.driver),
        session: stated(run.entry.session),
        t0_s: run.t0_s,
        rate_hz: run.rate_hz,
        columns: pack_all(run.columns),
        model: pack_all(run.model),
        stretches: run.examination.stretches,
        sections: run.sections,
        contacts: run.contacts,
        faults: run.examination.faults,
        notes: run.examination.notes,
    }
}
