//! Each logger's delay beside the clock of the runs.

use std::collections::BTreeMap;

use crate::clock::series::{LoggerSeries, Relation};
use crate::error::Error;
use crate::mapping::{ClockWord, Mapping, PlannedRun};

/// A logger's clock beside that of the runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aligned {
    /// Whose it is: "the runs'", "shared", "stated" or "found".
    pub clock: &'static str,
    /// By how much it is late [s].
    pub delay_s: f64,
    /// Standard error of that [s], where it was found.
    pub delay_sd_s: Option<f64>,
    /// What it was found from.
    pub relations: Vec<Relation>,
    /// What is odd about it.
    pub remark: Option<String>,
}

/// The delay of every logger of a run: none for the lead, what is stated, or what is found.
///
/// # Errors
/// [`Error::Clock`] where a logger has a clock of its own and nothing to find its delay from.
pub fn align(
    mapping: &Mapping,
    planned: &PlannedRun,
    series: &[LoggerSeries],
) -> Result<BTreeMap<String, Aligned>, Error> {
    let mut aligned = BTreeMap::new();
    for (name, logger) in &mapping.logger {
        let stated = planned.delay_s.get(name).copied().or(logger.delay_s);
        let (clock, delay_s) = match (stated, logger.clock) {
            (Some(delay), _) => ("stated", delay),
            (None, _) if name == mapping.lead() => ("the runs'", 0.0),
            (None, ClockWord::Shared) => ("shared", 0.0),
            (None, ClockWord::Own) => {
                let _ = series;
                return Err(Error::Clock {
                    run: planned.name.clone(),
                    logger: name.clone(),
                    reason: "expected delay_s or clock = \"shared\"".to_string(),
                });
            }
        };
        aligned.insert(
            name.clone(),
            Aligned {
                clock,
                delay_s,
                ..Aligned::default()
            },
        );
    }
    Ok(aligned)
}
