//! What the channels of one file may be.

use std::collections::BTreeMap;

use crate::guess::name::{by_name, time_rank};
use crate::guess::value::{Said, extent, time_unit, unit_by_values};
use crate::source::{Channel, Log};
use crate::unit::{column_unit, conversion};

/// A channel that may be a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guess {
    pub from: String,
    /// The unit to write; none where the file states it.
    pub unit: Option<&'static str>,
    /// -1 where the values say so.
    pub negative: bool,
    /// Weight of the name.
    pub weight: usize,
    /// How sure, and why.
    pub why: String,
    /// Units that it may be, where nothing decides.
    pub open: Option<&'static [&'static str]>,
}

/// What a file's channels may be.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// The time channel, its unit where the file does not say it, and why.
    pub time: Option<(String, Option<&'static str>, String)>,
    /// Whether the file has times of its own.
    pub clocked: bool,
    pub columns: BTreeMap<&'static str, Guess>,
    /// Channels that are nothing known.
    pub others: Vec<String>,
}

/// Guesses by names, then by what the file states, then by values.
pub(crate) fn sample(log: &Log) -> Sample {
    let mut found = Sample {
        clocked: !log.clocks.is_empty(),
        ..Sample::default()
    };
    let mut times: Vec<(usize, &Channel, Option<&'static str>, String)> = Vec::new();
    for channel in &log.channels {
        if let (Some(rank), Some(said)) = (time_rank(&channel.name), time_unit(&channel.values)) {
            let stated = channel
                .unit
                .as_deref()
                .filter(|unit| conversion(unit, "s").is_ok());
            let (unit, why) = match (stated, said) {
                (Some(unit), _) => (None, format!("the file says {unit}")),
                (None, Said::Unit(unit, why)) => (Some(unit), why),
                (None, Said::Open(_, why)) => (Some("s"), format!("? s, ms or us: {why}")),
            };
            times.push((rank, channel, unit, why));
            continue;
        }
        match by_name(&channel.name) {
            None => found.others.push(channel.name.clone()),
            Some(named) => {
                let guess = guess(channel, named.column, named.weight, named.own);
                let better = found
                    .columns
                    .get(named.column)
                    .is_none_or(|known| known.weight < guess.weight);
                let loser = if better {
                    found.columns.insert(named.column, guess)
                } else {
                    Some(guess)
                };
                found.others.extend(loser.map(|loser| loser.from));
            }
        }
    }
    if let Some((_, channel, unit, why)) = times.into_iter().min_by_key(|time| time.0) {
        found.time = Some((channel.name.clone(), unit, why));
    }
    share_unit(&mut found.columns, &["az_mps2", "ax_mps2", "ay_mps2"]);
    share_unit(
        &mut found.columns,
        &["yaw_rate_radps", "roll_rate_radps", "pitch_rate_radps"],
    );
    found
}

/// The axes of one accelerometer, and of one gyroscope, have one unit: that of the first whose values decide.
fn share_unit(columns: &mut BTreeMap<&'static str, Guess>, axes: &[&'static str]) {
    let decided = axes.iter().find_map(|axis| {
        let guess = columns.get(axis).filter(|guess| guess.open.is_none())?;
        Some((guess.unit?, guess.from.clone()))
    });
    let Some((unit, from)) = decided else { return };
    for axis in axes {
        if let Some(guess) = columns.get_mut(axis).filter(|guess| guess.open.is_some()) {
            guess.unit = Some(unit);
            guess.open = None;
            guess.why = format!("likely: by its name; {unit} as {from:?}");
        }
    }
}

fn guess(channel: &Channel, column: &'static str, weight: usize, own: bool) -> Guess {
    let stated = channel
        .unit
        .as_deref()
        .filter(|unit| conversion(unit, column_unit(column)).is_ok());
    let name = if own {
        "sure: the name is kufe's own"
    } else {
        "likely: by its name"
    };
    let (unit, open, mut why) = match (stated, unit_by_values(column, &channel.values)) {
        (Some(unit), _) => (None, None, format!("{name}; the file says {unit}")),
        (None, Some(Said::Unit(unit, why))) => (Some(unit), None, format!("{name}; {why}")),
        (None, Some(Said::Open(units, why))) => (None, Some(units), why),
        (None, None) => (None, Some(&["?"][..]), "it holds no values".to_string()),
    };
    let median = extent(&channel.values).map_or(0.0, |[median, _]| median);
    let negative = column == "az_mps2" && median < 0.0 && open.is_none();
    if negative {
        why += "; its axis points down";
    }
    Guess {
        from: channel.name.clone(),
        unit,
        negative,
        weight,
        why,
        open,
    }
}
