//! Whether a run's columns are what their names say.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::error::Error;
use crate::record::check::clock::{Base, Clock};
use crate::record::check::gaps::{Gaps, LEAST_SPEED, OnGaps};
use crate::record::check::saturation::Saturation;
use crate::record::columns::Columns;

/// Fewest samples of a run that filters and derivatives can work on.
pub const LEAST_SAMPLES: usize = 64;

/// Checks the columns of one run, brings them to a uniform clock and says what takes part.
///
/// `required` are the columns there must be besides `t_s`; `used` those of the file that must have a value where a sample
/// takes part; `file` names the source in errors. In this order: missing columns, too few samples, time (backwards, jumps),
/// values missing altogether. `t_s` is taken out of the columns. With [`OnGaps::Refuse`]
/// irregular steps, missing values and standstill are errors. Sensors that stick at their extremes come beside.
///
/// # Errors
/// The first of these that is found, with its place.
pub fn check_columns(
    columns: &mut Columns,
    required: &[&str],
    used: &[&str],
    on_gaps: OnGaps,
    file: &str,
) -> Result<(Clock, Gaps, BTreeMap<String, Saturation>), Error> {
    for name in std::iter::once("t_s").chain(required.iter().copied()) {
        if !columns.contains_key(name) {
            return Err(Error::MissingColumn {
                file: file.to_string(),
                column: name.to_string(),
                found: columns.keys().cloned().collect::<Vec<_>>().join(", "),
                needed_by: None,
            });
        }
    }
    let mut time = columns.remove("t_s").unwrap_or_default();
    if time.len() < LEAST_SAMPLES {
        return Err(Error::TooShort {
            file: file.to_string(),
            samples: time.len(),
            needed: LEAST_SAMPLES,
        });
    }
    if on_gaps == OnGaps::Refuse {
        refuse_gaps(columns, &time, used, file)?;
    }
    let rows: Vec<usize> = (0..time.len()).filter(|i| time[*i].is_finite()).collect();
    if rows.len() < LEAST_SAMPLES {
        refuse_missing(&time, &time, "t_s", file)?;
    }
    if rows.len() < time.len() {
        for column in columns.values_mut().chain([&mut time]) {
            *column = rows.iter().map(|i| column[*i]).collect();
        }
    }
    let base = Base::of(&time, &|i| rows[i] as u64 + 2, file)?;
    for name in used {
        if columns[*name].iter().all(|x| !x.is_finite()) {
            refuse_missing(&columns[*name], &time, name, file)?;
        }
    }
    for column in columns.values_mut() {
        *column = base.column(std::mem::take(column));
    }
    let speed = columns.get("v_mps").cloned();
    let mut gaps = Gaps::find(columns, used, base.clock.dt_s);
    gaps.jitter = base.jitter;
    let left: usize = gaps.pieces.iter().map(Range::len).sum();
    if left == 0
        && let Some(speed) = speed.filter(|v| v.iter().all(|v| *v <= LEAST_SPEED))
    {
        return Err(standstill(file, 2, speed[0], time[0]));
    }
    if left < LEAST_SAMPLES {
        return Err(Error::TooFew {
            what: format!(
                "{file}: samples with a value in every channel, in stretches long enough for the filter"
            ),
            found: left,
            needed: LEAST_SAMPLES,
        });
    }
    let clock = Clock {
        t0_s: base.clock.t0_s + gaps.cut_s[0],
        ..base.clock
    };
    let saturated = used
        .iter()
        .filter_map(|name| Some(((*name).to_string(), Saturation::of(&columns[*name])?)))
        .collect();
    Ok((clock, gaps, saturated))
}

/// Refuses what [`OnGaps::LeaveOut`] leaves out: values without a number, uneven time, standstill.
fn refuse_gaps(columns: &Columns, time: &[f64], used: &[&str], file: &str) -> Result<(), Error> {
    refuse_missing(time, time, "t_s", file)?;
    refuse_uneven(time, file)?;
    for name in used {
        refuse_missing(&columns[*name], time, name, file)?;
    }
    let speed = columns.get("v_mps").filter(|_| used.contains(&"v_mps"));
    match speed.and_then(|speed| Some((speed, speed.iter().position(|v| *v <= LEAST_SPEED)?))) {
        Some((speed, at)) => Err(standstill(file, at as u64 + 2, speed[at], time[at])),
        None => Ok(()),
    }
}

fn standstill(file: &str, row: u64, v_mps: f64, t_s: f64) -> Error {
    Error::Standstill {
        file: file.to_string(),
        row,
        v_mps,
        t_s,
        least: LEAST_SPEED,
    }
}

fn refuse_uneven(time: &[f64], file: &str) -> Result<(), Error> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    for (i, pair) in time.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        let what = if step <= 0.0 {
            "time stands still or runs backwards"
        } else if step > 1.5 * median {
            "clock jump or gap"
        } else if (step - median).abs() > 0.05 * median {
            "irregular time"
        } else {
            continue;
        };
        return Err(Error::Time {
            file: file.to_string(),
            row: i as u64 + 3,
            what,
            step_s: step,
            t_s: pair[0],
            expected_s: median,
        });
    }
    Ok(())
}

fn refuse_missing(values: &[f64], time: &[f64], column: &str, file: &str) -> Result<(), Error> {
    let missing = |value: &f64| !value.is_finite();
    let Some(first) = values.iter().position(missing) else {
        return Ok(());
    };
    let length = values[first..].iter().take_while(|v| missing(v)).count();
    let bursts = values
        .windows(2)
        .filter(|pair| !missing(&pair[0]) && missing(&pair[1]))
        .count()
        + usize::from(missing(&values[0]));
    Err(Error::Missing {
        file: file.to_string(),
        column: column.to_string(),
        count: length,
        row: first as u64 + 2,
        t_s: time[first],
        bursts,
        total: values.iter().filter(|v| missing(v)).count(),
    })
}
