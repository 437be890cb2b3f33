//! Checks of single columns of a run, and their interpolation to a uniform time base.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::columns::{Columns, FileColumns};
use crate::error::Error;
use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps, Saturation};
use crate::series::median;

/// Largest magnitude of a used column, in its unit: no sled reaches it.
pub const LARGEST_VALUE: f64 = 1e6;
/// Largest magnitude of a time [s].
const LARGEST_TIME_S: f64 = 1e15;

/// Fewest samples of a run, for filters and derivatives.
pub const MIN_RUN_SAMPLES: usize = 64;

/// Checks the columns of one run, interpolates them to a uniform time base, and finds the samples
/// that are used and the saturated channels.
///
/// `required` are the columns of the file besides `t_s`; `used` are those that must have a value in a
/// used sample; `file` names the source in errors. `t_s` is removed from the columns. `lines` remain
/// those of the rows with a time.
///
/// # Errors
/// The first of these, with its place: a missing column, a number out of range, too few samples, time
/// that runs backwards or jumps, a column without values. With [`OnGaps::Refuse`] also irregular
/// steps, missing values and standstill.
pub fn check_columns(
    FileColumns { columns, lines }: &mut FileColumns,
    required: &[&str],
    used: &[&str],
    on_gaps: OnGaps,
    file: &str,
) -> Result<(Clock, Gaps, BTreeMap<String, Saturation>), Error> {
    let mut needed = ["t_s"].into_iter().chain(required.iter().copied());
    if let Some(name) = needed.find(|name| !columns.contains_key(*name)) {
        return Err(Error::missing_column(file, name, columns.keys()));
    }
    let too_large = |name: &str, most: f64| {
        let row = columns[name].iter().position(|value| value.abs() > most)?;
        let expected = format!("a number between -{most:e} and {most:e}");
        let found = format!("{:e}", columns[name][row]);
        Some(Error::cell(file, lines[row], name, found, &expected))
    };
    let of_used = || used.iter().find_map(|name| too_large(name, LARGEST_VALUE));
    if let Some(error) = too_large("t_s", LARGEST_TIME_S).or_else(of_used) {
        return Err(error);
    }
    let mut time = columns.remove("t_s").unwrap_or_default();
    if time.len() < MIN_RUN_SAMPLES {
        let what = format!("{file}: samples");
        return Err(Error::too_few(what, time.len(), MIN_RUN_SAMPLES));
    }
    if on_gaps == OnGaps::Refuse {
        refuse_gaps(columns, &time, lines, used, file)?;
    }
    let rows: Vec<usize> = (0..time.len()).filter(|i| time[*i].is_finite()).collect();
    if rows.len() < MIN_RUN_SAMPLES {
        refuse_missing(&time, &time, lines, "t_s", file)?;
    }
    if rows.len() < time.len() {
        for column in columns.values_mut().chain([&mut time]) {
            *column = rows.iter().map(|i| column[*i]).collect();
        }
        *lines = rows.iter().map(|i| lines[*i]).collect();
    }
    let base = TimeBase::of(&time, lines, file)?;
    for name in used {
        if columns[*name].iter().all(|x| !x.is_finite()) {
            refuse_missing(&columns[*name], &time, lines, name, file)?;
        }
    }
    for column in columns.values_mut() {
        *column = base.column(column);
    }
    let speed = columns.get("v_mps").cloned();
    let mut gaps = Gaps::find(columns, used, base.clock.dt_s);
    gaps.jitter = base.jitter;
    let samples: usize = gaps.pieces.iter().map(Range::len).sum();
    if samples == 0
        && let Some(speed) = speed.filter(|v| v.iter().all(|v| *v <= LEAST_SPEED))
    {
        return Err(standstill(file, lines[0], speed[0], time[0]));
    }
    if samples < MIN_RUN_SAMPLES {
        let what = format!(
            "{file}: samples with a value in every channel, in stretches long enough for the filter"
        );
        return Err(Error::too_few(what, samples, MIN_RUN_SAMPLES));
    }
    let clock = Clock {
        t0_s: base.clock.t0_s + gaps.cut_s[0],
        ..base.clock
    };
    let saturation = |name: &&str| Some((name.to_string(), Saturation::of(&columns[*name])?));
    let saturated = used.iter().filter_map(saturation).collect();
    Ok((clock, gaps, saturated))
}

/// Refuses what [`OnGaps::LeaveOut`] excludes: missing values, uneven time, standstill.
fn refuse_gaps(
    columns: &Columns,
    time: &[f64],
    lines: &[u64],
    used: &[&str],
    file: &str,
) -> Result<(), Error> {
    refuse_missing(time, time, lines, "t_s", file)?;
    refuse_uneven(time, lines, file)?;
    for name in used {
        refuse_missing(&columns[*name], time, lines, name, file)?;
    }
    if used.contains(&"v_mps")
        && let Some(speed) = columns.get("v_mps")
        && let Some(at) = speed.iter().position(|v| *v <= LEAST_SPEED)
    {
        return Err(standstill(file, lines[at], speed[at], time[at]));
    }
    Ok(())
}

fn standstill(file: &str, row: u64, v_mps: f64, t_s: f64) -> Error {
    let reason = format!(
        "v_mps = {v_mps} at t = {t_s:.3} s, expected more than {LEAST_SPEED} m/s (no slip angle exists at standstill: cut that part off)"
    );
    Error::row(file, row, reason)
}

/// The error of a time step that starts at `t_s` [s]; `row` is that of the later sample.
fn bad_step(file: &str, row: u64, what: &str, [t_s, step, expected]: [f64; 3]) -> Error {
    let reason = format!(
        "{what}: t_s steps by {step:.6} s at t = {t_s:.4} s, expected {expected:.6} s throughout"
    );
    Error::row(file, row, reason)
}

fn refuse_uneven(time: &[f64], lines: &[u64], file: &str) -> Result<(), Error> {
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let median = median(steps.clone()).unwrap_or(0.0);
    for (i, step) in steps.enumerate() {
        let what = if step <= 0.0 {
            "time is constant or runs backwards"
        } else if step > 1.5 * median {
            "clock jump or gap"
        } else if (step - median).abs() > 0.05 * median {
            "irregular time"
        } else {
            continue;
        };
        return Err(bad_step(file, lines[i + 1], what, [time[i], step, median]));
    }
    Ok(())
}

fn refuse_missing(
    values: &[f64],
    time: &[f64],
    lines: &[u64],
    column: &str,
    file: &str,
) -> Result<(), Error> {
    let missing = |value: &f64| !value.is_finite();
    let Some(first) = values.iter().position(missing) else {
        return Ok(());
    };
    let bursts = values.chunk_by(|a, b| missing(a) == missing(b));
    let bursts: Vec<&[f64]> = bursts.filter(|burst| missing(&burst[0])).collect();
    let (length, count) = (bursts[0].len(), bursts.len());
    let total: usize = bursts.iter().map(|burst| burst.len()).sum();
    let (row, t_s) = (lines[first], time[first]);
    let reason = format!(
        "column {column}: {length} values are NaN or missing from row {row} on (t = {t_s:.3} s); {count} such bursts in all, {total} values; expected a number in every row: nothing is filled in"
    );
    Err(Error::file(file, reason))
}

/// Start and step of a uniform time base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample [s].
    pub t0_s: f64,
    /// Time between samples [s].
    pub dt_s: f64,
}

/// Relative deviation of a step that rounded times explain.
const ROUNDING: f64 = 0.05;
/// Smallest typical step [s]: a smaller one shows an error of the clock or of its unit.
const MIN_STEP_S: f64 = 1e-5;
/// Ratio to the typical step of a step between successive rows; rows are missing in a longer one.
const ONE_STEP: std::ops::Range<f64> = 0.5..1.5;

/// The uniform time base of a file's rows, and the interpolation of its columns.
#[derive(Clone, Debug)]
pub struct TimeBase {
    /// Start and step.
    pub clock: Clock,
    /// Number of samples.
    pub len: usize,
    /// Largest distance of a row from its sample, in steps; 0 if columns are not interpolated.
    pub jitter: f64,
    /// The sample of each row.
    places: Vec<usize>,
    /// The time of each row [s] if columns are interpolated.
    times: Option<Vec<f64>>,
}

impl TimeBase {
    /// The time base of rows at increasing `time` [s]; `lines` are those of the rows in the file, for
    /// errors.
    ///
    /// A step of 1.5 times the typical step or more is a gap: its samples have no value. Rows remain
    /// unchanged if their steps differ by less than 5 %. If rows are farther than 5 % of a step from
    /// the base, by jitter, drift or a restart of the logger, [`TimeBase::column`] interpolates.
    ///
    /// # Errors
    /// [`Error::Row`] if time does not increase, a step is less than half the typical step, or time
    /// jumps farther than the recorded duration.
    pub fn of(time: &[f64], lines: &[u64], file: &str) -> Result<TimeBase, Error> {
        let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let typical = typical_step(&steps);
        let step = |i: usize, what, expected| {
            bad_step(file, lines[i + 1], what, [time[i], steps[i], expected])
        };
        let error = |i: usize, what| step(i, what, typical);
        if let Some(i) = steps.iter().position(|step| *step <= 0.0) {
            return Err(error(i, "time is constant or runs backwards"));
        }
        if typical < MIN_STEP_S {
            return Err(step(0, "more than 100 000 rows a second", MIN_STEP_S));
        }
        if let Some(i) = steps
            .iter()
            .position(|step| *step < ONE_STEP.start * typical)
        {
            return Err(error(i, "irregular time"));
        }
        let (first, last) = (time[0], time[time.len() - 1]);
        let mut places = vec![0.0_f64];
        for (i, step) in steps.iter().enumerate() {
            let whole = (step / typical).round().max(1.0);
            // A gap with more samples than there are rows is a jump of the clock.
            if whole > time.len() as f64 {
                return Err(error(i, "clock jump"));
            }
            places.push(places[i] + whole);
        }
        let total = places[steps.len()];
        let clock = Clock {
            t0_s: first,
            dt_s: (last - first) / total,
        };
        let len = total as usize + 1;
        if len > 2 * time.len() {
            let longest = (0..steps.len()).max_by(|a, b| steps[*a].total_cmp(&steps[*b]));
            return Err(error(longest.unwrap_or(0), "clock jump"));
        }
        let drift = |(t, place): (&f64, &f64)| ((t - first) / clock.dt_s - place).abs();
        let jitter = time.iter().zip(&places).map(drift).fold(0.0, f64::max);
        let is_close = |step: &f64| (step - typical).abs() <= ROUNDING * typical;
        let on_base = jitter <= ROUNDING || jitter < 0.5 && steps.iter().all(is_close);
        Ok(TimeBase {
            clock,
            len,
            jitter: if on_base { 0.0 } else { jitter },
            places: places.into_iter().map(|place| place as usize).collect(),
            times: (!on_base).then(|| time.to_vec()),
        })
    }

    /// A column of the file on the time base: NaN in gaps. Between rows, the cubic through the four
    /// nearest rows; next to gaps, linear interpolation.
    pub fn column(&self, values: &[f64]) -> Vec<f64> {
        if let Some(times) = &self.times {
            let mut before = 0;
            let sample = |i: usize| {
                let t = self.clock.t0_s + i as f64 * self.clock.dt_s;
                while before + 2 < times.len() && times[before + 1] <= t {
                    before += 1;
                }
                self.between(times, values, before, t)
            };
            return (0..self.len).map(sample).collect();
        }
        let mut column = vec![f64::NAN; self.len];
        for (place, value) in self.places.iter().zip(values) {
            column[*place] = *value;
        }
        column
    }

    /// The value at `t` between rows `i` and `i + 1`.
    fn between(&self, time: &[f64], x: &[f64], i: usize, t: f64) -> f64 {
        let dt = self.clock.dt_s;
        let is_near = |k: &usize| (time[*k] - t).abs() < ROUNDING * dt;
        if let Some(k) = [i, i + 1].into_iter().find(is_near) {
            return x[k];
        }
        let is_one_step = |a: usize| ONE_STEP.contains(&((time[a + 1] - time[a]) / dt));
        if !is_one_step(i) {
            return f64::NAN;
        }
        if i > 0 && i + 2 < time.len() && is_one_step(i - 1) && is_one_step(i + 1) {
            let cubic = lagrange(&time[i - 1..i + 3], &x[i - 1..i + 3], t);
            if cubic.is_finite() {
                return cubic;
            }
        }
        x[i] + (x[i + 1] - x[i]) * (t - time[i]) / (time[i + 1] - time[i])
    }
}

/// The mean of the steps that are no gaps, by comparison with the median step.
fn typical_step(steps: &[f64]) -> f64 {
    let median = median(steps.iter().copied()).unwrap_or(0.0);
    let single = steps
        .iter()
        .filter(|step| ONE_STEP.contains(&(*step / median)));
    let (sum, count) = single.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
    if count > 0.0 { sum / count } else { median }
}

/// The polynomial through the points `(t, x)` at `at`, by Lagrange's formula.
fn lagrange(t: &[f64], x: &[f64], at: f64) -> f64 {
    (0..t.len())
        .map(|i| {
            let others = (0..t.len()).filter(|j| *j != i);
            x[i] * others.map(|j| (at - t[j]) / (t[i] - t[j])).product::<f64>()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn base(time: &[f64]) -> Result<TimeBase, Error> {
        let lines: Vec<u64> = (2..).take(time.len()).collect();
        TimeBase::of(time, &lines, "run.csv")
    }

    #[test]
    fn missing_rows_become_samples_without_values() {
        let time: Vec<f64> = (0..200)
            .filter(|i| !(50..60).contains(i) && *i != 120)
            .map(|i| 3.0 + 0.002 * f64::from(i))
            .collect();
        let base = base(&time).unwrap();
        assert_eq!((base.len, base.jitter), (200, 0.0));
        let column = base.column(&time);
        for (i, t) in column.iter().enumerate() {
            let gone = (50..60).contains(&i) || i == 120;
            assert_eq!(t.is_nan(), gone, "{i}");
            assert!(gone || (t - 3.0 - 0.002 * i as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn jitter_of_a_quarter_of_a_step_leaves_a_slow_wave_as_it_was() {
        // 8 Hz at 500 Hz: the cubic's error is (2 pi 8 0.002)^4 times 3/128 at most, widened by the
        // jitter.
        let wave = |t: f64| (std::f64::consts::TAU * 8.0 * t).sin();
        let mut state = 1_u32;
        let mut time: Vec<f64> = (0..1000)
            .map(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let share = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
                0.002 * (f64::from(i) + 0.48 * share)
            })
            .collect();
        (time[0], time[999]) = (0.0, 0.002 * 999.0);
        let base = base(&time).unwrap();
        assert!(base.jitter > 0.2 && base.len == 1000);
        let values = base.column(&time.iter().map(|t| wave(*t)).collect::<Vec<_>>());
        for (i, value) in values.iter().enumerate().skip(2).take(996) {
            let expected = wave(0.002 * i as f64);
            // A row within 5 % of a step is taken as it is: its slope times that.
            let taken = 0.05 * 0.002 * std::f64::consts::TAU * 8.0;
            assert!((value - expected).abs() < taken + 1e-5, "{i}");
        }
    }

    #[test]
    fn a_logger_that_begins_anew_between_steps_is_interpolated_and_its_gap_stays_empty() {
        let time: Vec<f64> = (0..100)
            .map(|i| 0.01 * f64::from(i))
            .chain((0..100).map(|i| 1.5037 + 0.01 * f64::from(i)))
            .collect();
        let base = base(&time).unwrap();
        let column = base.column(&time);
        for (i, t) in column.iter().enumerate() {
            let at = base.clock.t0_s + i as f64 * base.clock.dt_s;
            let inside = (0.991..1.503).contains(&at);
            assert_eq!(t.is_nan(), inside, "{at}");
            assert!(inside || (t - at).abs() < 0.05 * 0.01 + 1e-9, "{at} {t}");
        }
    }

    #[test]
    fn clocks_that_run_backwards_or_jump_beyond_what_is_recorded_are_placed() {
        let mut time: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
        time[40] = 0.2;
        let error = base(&time).unwrap_err().to_string();
        assert!(
            error.contains("row 42") && error.contains("backwards"),
            "{error}"
        );
        let jumped: Vec<f64> = (0..100)
            .map(|i| 0.01 * f64::from(i) + if i > 30 { 1e12 } else { 0.0 })
            .collect();
        let error = base(&jumped).unwrap_err().to_string();
        assert!(
            error.contains("row 33") && error.contains("clock jump"),
            "{error}"
        );
    }
}
