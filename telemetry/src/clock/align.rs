//! Each logger's delay beside the clock of the runs.

use std::collections::BTreeMap;

use crate::clock::delay::delay;
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
/// A clock is found from what its channels share with those of loggers whose clocks are known already: the same column in
/// both, and the motion of a rigid body, `a_x = dv/dt`, `a_y = r v - d(alpha v)/dt + x dr/dt`, `a_z = g - q v - x dq/dt` with x
/// from the accelerometer's place. What these leave open, an unknown place (0.2 m over the speed) or unmeasured slip
/// (0.03 s), is part of the error that is stated.
///
/// # Errors
/// [`Error::Clock`] where a logger has a clock of its own and its delay cannot be found.
pub fn align(
    mapping: &Mapping,
    planned: &PlannedRun,
    series: &[LoggerSeries],
) -> Result<BTreeMap<String, Aligned>, Error> {
    let mut aligned = BTreeMap::new();
    let mut open: Vec<&str> = Vec::new();
    for (name, logger) in &mapping.logger {
        let stated = planned.delay_s.get(name).copied().or(logger.delay_s);
        let (clock, delay_s) = match (stated, logger.clock) {
            (Some(delay), _) => ("stated", delay),
            (None, _) if name == mapping.lead() => ("the runs'", 0.0),
            (None, ClockWord::Shared) => ("shared", 0.0),
            (None, ClockWord::Own) => {
                open.push(name);
                continue;
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
    if open.is_empty() {
        return Ok(aligned);
    }
    let place = |column: &str| {
        mapping
            .channels
            .get(column)
            .and_then(|c| c.place_m)
            .map(|[x, ..]| x)
    };
    let mut known: Vec<LoggerSeries> = Vec::new();
    let add = |name: &str, delay_s: f64, known: &mut Vec<LoggerSeries>| {
        for own in series.iter().filter(|own| own.logger == name) {
            let mut own = own.clone();
            own.series.time.iter_mut().for_each(|t| *t -= delay_s);
            known.push(own);
        }
    };
    for (name, one) in &aligned {
        add(name, one.delay_s, &mut known);
    }
    // One that is related to no known logger may be related to one that is found meanwhile.
    while !open.is_empty() {
        let mut reasons = Vec::new();
        let before = open.len();
        let mut still = Vec::new();
        for name in open {
            let late: Vec<&LoggerSeries> = series.iter().filter(|own| own.logger == name).collect();
            match delay(&late, &known, &place, mapping.logger[name].largest_delay_s) {
                Ok(found) => {
                    add(name, found.delay_s, &mut known);
                    let remark = found
                        .remark
                        .map(|text| format!("run {}: logger {name}: {text}", planned.name));
                    aligned.insert(
                        name.to_string(),
                        Aligned {
                            clock: "found",
                            delay_s: found.delay_s,
                            delay_sd_s: Some(found.sd_s),
                            relations: found.relations,
                            remark,
                        },
                    );
                }
                Err(reason) => {
                    reasons.push(reason);
                    still.push(name);
                }
            }
        }
        if still.len() == before {
            return Err(Error::Clock {
                run: planned.name.clone(),
                logger: still[0].to_string(),
                reason: format!(
                    "{}; expected a channel that another logger has too (logger.{}.also), its delay_s, or clock = \"shared\"",
                    reasons[0], still[0]
                ),
            });
        }
        open = still;
    }
    Ok(aligned)
}
