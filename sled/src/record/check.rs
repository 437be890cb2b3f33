//! Whether a run's columns are what their names say.

use std::collections::BTreeMap;

use crate::error::Error;

/// Fewest samples of a run that filters and derivatives can work on.
pub const LEAST_SAMPLES: usize = 64;
/// Least speed [m/s] at which a slip angle is taken to exist.
pub const LEAST_SPEED: f64 = 0.1;

/// Start and step of a uniform time column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample [s].
    pub t0_s: f64,
    /// Time between samples [s].
    pub dt_s: f64,
}

/// Checks the columns of one run and returns its clock, with remarks on what is odd but no error.
///
/// `required` are the columns there must be besides `t_s`; `file` names the source in errors. In this order: missing
/// columns, too few samples, time (backwards, jumps, irregular steps), values missing in required columns, units by
/// range (degrees, g, km/h), standstill. A sensor that sticks at its extreme for more than a few samples is a remark.
///
/// # Errors
/// The first of these that is found, with its place.
pub fn check_columns(
    columns: &BTreeMap<String, Vec<f64>>,
    required: &[&str],
    file: &str,
) -> Result<(Clock, Vec<String>), Error> {
    for name in std::iter::once("t_s").chain(required.iter().copied()) {
        if !columns.contains_key(name) {
            return Err(Error::MissingColumn {
                file: file.to_string(),
                column: name.to_string(),
                found: columns.keys().cloned().collect::<Vec<_>>().join(", "),
            });
        }
    }
    let time = &columns["t_s"];
    if time.len() < LEAST_SAMPLES {
        return Err(Error::TooShort {
            file: file.to_string(),
            samples: time.len(),
            needed: LEAST_SAMPLES,
        });
    }
    refuse_missing(time, time, "t_s", file)?;
    let clock = check_time(time, file)?;
    for name in required {
        refuse_missing(&columns[*name], time, name, file)?;
    }
    for name in required {
        check_unit(name, &columns[*name], file)?;
    }
    if let Some(speed) = required.iter().find(|name| **name == "v_mps") {
        let speed = &columns[*speed];
        if let Some(at) = speed.iter().position(|v| *v <= LEAST_SPEED) {
            return Err(Error::Standstill {
                file: file.to_string(),
                row: at as u64 + 2,
                v_mps: speed[at],
                t_s: time[at],
                least: LEAST_SPEED,
            });
        }
    }
    let remarks = required
        .iter()
        .filter_map(|name| at_end_stop(name, &columns[*name], time))
        .map(|remark| format!("{file}: {remark}"))
        .collect();
    Ok((clock, remarks))
}

fn check_time(time: &[f64], file: &str) -> Result<Clock, Error> {
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
    let (first, last) = (time[0], time[time.len() - 1]);
    Ok(Clock {
        t0_s: first,
        dt_s: (last - first) / (time.len() - 1) as f64,
    })
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

/// What no sled reaches in the column's unit but easily does in the usual wrong one.
fn check_unit(column: &str, values: &[f64], file: &str) -> Result<(), Error> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let told = |found: String, looks_like, expected| {
        Err(Error::Unit {
            file: file.to_string(),
            column: column.to_string(),
            found,
            looks_like,
            expected,
        })
    };
    let most = format!("largest magnitude {largest:.4}");
    match column {
        "alpha_rad" | "gamma_rad" if largest > 0.4 => told(
            most,
            "degrees",
            "radians, magnitudes below 0.4 (23 degrees)",
        ),
        "delta_rad" if largest > 0.6 => told(
            most,
            "degrees",
            "radians, magnitudes below 0.6 (34 degrees)",
        ),
        "roll_rate_radps" | "pitch_rate_radps" | "yaw_rate_radps" if largest > 12.0 => told(
            most,
            "degrees per second",
            "radians per second, magnitudes below 12",
        ),
        "v_mps" if largest > 70.0 => told(most, "km/h", "metres per second, below 70"),
        "ax_mps2" | "ay_mps2" | "az_mps2" if largest > 500.0 => told(
            most,
            "a raw count or another unit",
            "metres per second squared, magnitudes below 500",
        ),
        "az_mps2" => {
            let mut sorted = values.to_vec();
            let middle = sorted.len() / 2;
            let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
            if (0.5..4.5).contains(&median.abs()) {
                return told(
                    format!("median {median:.3}"),
                    "multiples of g",
                    "metres per second squared, +9.81 at rest on level ice",
                );
            }
            if median < 0.0 {
                return told(
                    format!("median {median:.3}"),
                    "an axis that points down",
                    "specific force upwards, +9.81 at rest on level ice",
                );
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

/// A stretch of equal samples at the column's extreme, as a saturated sensor gives.
fn at_end_stop(column: &str, values: &[f64], time: &[f64]) -> Option<String> {
    const STRETCH: usize = 8;
    let extreme = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if extreme == 0.0 || values.iter().all(|v| v.abs() == extreme) {
        return None;
    }
    let (mut length, mut longest, mut end) = (0, 0, 0);
    for (i, value) in values.iter().enumerate() {
        length = if value.abs() == extreme {
            length + 1
        } else {
            0
        };
        if length > longest {
            (longest, end) = (length, i);
        }
    }
    (longest >= STRETCH).then(|| {
        format!(
            "column {column} stays at its extreme {extreme} for {longest} samples from t = {:.3} s on: saturated?",
            time[end + 1 - longest]
        )
    })
}
