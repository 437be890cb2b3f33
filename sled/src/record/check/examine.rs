//! Runs examined: faults, oddities, and the profile of every channel.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use crate::column::{COLUMNS, Sensor};
use crate::columns::read_columns;
use crate::error::Error;
use crate::fault::Fault;
use crate::record::check::judge::judge;
use crate::record::check::odd_stretch::{OddStretch, odd_stretches};
use crate::record::check::profile::{Profile, longest_still};
use crate::record::check::rigid_body::{Slow, delays};
use crate::record::files::{find_copy, read_run};
use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps};
use crate::record::index::{Entry, read_index};
use crate::record::needs::Needs;
use crate::record::run::Run;

/// Columns that every run must have; the others are judged where they are recorded.
const LEAST: [&str; 1] = ["v_mps"];
/// Length of a stretch of one value [s] that is reported.
const STILL_S: f64 = 0.5;
/// Standstill [s] whose mean is a bias.
const REST_S: f64 = 1.0;
/// Delays [s] below this are not reported, nor those below five standard errors: clean runs show
/// 0.074 +- 0.020 for a quiet channel.
const LATE_S: f64 = 0.05;

/// Something odd that no one can prove wrong from the run alone.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Note {
    /// The channel; empty for the whole run.
    pub column: String,
    /// What is odd.
    pub what: String,
    /// What to do.
    pub advice: String,
    /// Larger is worse: the share of the run that it costs, about.
    pub weight: f64,
}

/// Faults, notes and channels of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Examination {
    /// Name of the run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// Why it cannot be used at all.
    pub refused: Option<String>,
    /// Faults, proved or suspected.
    pub faults: Vec<Fault>,
    /// What is odd, worst first.
    pub notes: Vec<Note>,
    /// Gaps.
    pub gaps: Gaps,
    /// Rows a second [Hz].
    pub rate_hz: f64,
    /// Length [s].
    pub length_s: f64,
    /// Time that takes part [s].
    pub used_s: f64,
    /// Every channel.
    pub channels: BTreeMap<String, Profile>,
    /// Where channels are odd for a while.
    pub stretches: Vec<OddStretch>,
}

impl Examination {
    /// Whether it has a proven fault.
    pub fn is_wrong(&self) -> bool {
        self.refused.is_some() || self.faults.iter().any(|fault| fault.proven)
    }
}

/// Examines every run of an index; the worst first, else in the index's order.
///
/// # Errors
/// Those of the index; errors of a run are in its examination.
pub fn examine(index: &Path) -> Result<Vec<Examination>, Error> {
    let examined = examine_with(index, |_, _| ())?;
    Ok(examined.into_iter().map(|(one, ())| one).collect())
}

/// Like [`examine`], with what `also` makes of each examination and, where it can be read, of its
/// run.
///
/// # Errors
/// As [`examine`].
pub fn examine_with<T: Send>(
    index: &Path,
    also: impl Fn(&Examination, Option<&Run>) -> T + Sync,
) -> Result<Vec<(Examination, T)>, Error> {
    let read = |entry: Entry| (entry.clone(), read_run(entry, &LEAST, OnGaps::LeaveOut));
    let read: Vec<_> = read_index(index)?.into_par_iter().map(read).collect();
    // Long recordings exist once in memory: runs in one list, their places in the index in another.
    let (mut runs, mut places, mut examined) = (Vec::new(), Vec::new(), Vec::new());
    for (place, (entry, run)) in read.into_iter().enumerate() {
        match run {
            Ok(run) => {
                runs.push(run);
                places.push(place);
            }
            Err(error) => {
                let one = Examination {
                    run: entry.run,
                    file: entry.file.display().to_string(),
                    refused: Some(error.to_string()),
                    ..Examination::default()
                };
                let made = also(&one, None);
                examined.push((place, (one, made)));
            }
        }
    }
    while let Some((first, second)) = find_copy(&runs) {
        let of = runs[first].entry.run.clone();
        let (copy, place) = (runs.remove(second), places.remove(second));
        let mut one = examine_run(&copy, Vec::new());
        let reason = format!("holds the same samples as run {of}: expected each run once");
        one.refused = Some(reason);
        let made = also(&one, Some(&copy));
        examined.push((place, (one, made)));
    }
    let faults = judge(&runs);
    examined.par_extend(runs.par_iter().zip(places).map(|(run, place)| {
        let own = faults.iter().filter(|fault| fault.run == run.entry.run);
        let one = examine_run(run, own.cloned().collect());
        let made = also(&one, Some(run));
        (place, (one, made))
    }));
    examined.sort_by_key(|(place, _)| *place);
    let mut examined: Vec<(Examination, T)> = examined.into_iter().map(|(_, both)| both).collect();
    let odd = |one: &Examination| one.notes.first().map_or(0.0, |note| note.weight);
    let rank = |one: &Examination| (one.refused.is_some(), one.faults.len());
    examined.sort_by(|(a, _), (b, _)| {
        let by_fault = rank(b).cmp(&rank(a));
        by_fault.then(odd(b).total_cmp(&odd(a)))
    });
    Ok(examined)
}

fn examine_run(run: &Run, faults: Vec<Fault>) -> Examination {
    let rate_hz = run.rate_hz();
    let rest = at_rest(run);
    let late = Slow::of(run).map(|slow| delays(&slow));
    let mut channels = BTreeMap::new();
    for (c, name) in COLUMNS.iter().enumerate() {
        let Some(column) = run.columns.get(*name) else {
            continue;
        };
        let delay = late.as_ref().and_then(|late| *late.get(c)?);
        // Not of a run with faults.
        let delay = delay.filter(|_| faults.is_empty());
        let profile = Profile {
            missing: run.gaps.missing.get(*name).copied().unwrap_or(0),
            at_standstill: rest.get(*name).copied(),
            delay_s: delay.map(|(delay, error)| [delay, error]),
            saturation: run.saturated.get(*name).copied(),
            ..Profile::of(run.gaps.within(column), rate_hz)
        };
        channels.insert((*name).to_string(), profile);
    }
    let used: usize = run.gaps.pieces.iter().map(std::ops::Range::len).sum();
    let (length_s, used_s) = (run.len() as f64 * run.dt_s, used as f64 * run.dt_s);
    let mut notes = notes(run, &channels, length_s, used_s);
    notes.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    Examination {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        refused: None,
        faults,
        notes,
        gaps: run.gaps.clone(),
        rate_hz,
        length_s,
        used_s,
        stretches: odd_stretches(run, &COLUMNS, STILL_S),
        channels,
    }
}

/// Means of the gyroscopes while the speed was 0, from the file itself: a run is cut to where it
/// moves.
fn at_rest(run: &Run) -> BTreeMap<String, f64> {
    let mut means = BTreeMap::new();
    if run.gaps.cut_s.iter().all(|cut| *cut < REST_S) && run.gaps.standstill == 0 {
        return means;
    }
    let columns = read_columns(&run.entry.file, &[]).unwrap_or_default();
    let Some(speed) = columns.get("v_mps") else {
        return means;
    };
    for name in Sensor::GYROSCOPE.map(Sensor::name) {
        let Some(column) = columns.get(name) else {
            continue;
        };
        let pairs = speed.iter().zip(column);
        let still = pairs.filter(|(v, x)| v.abs() <= LEAST_SPEED && x.is_finite());
        let (sum, count) = still.fold((0.0, 0_usize), |(s, n), (_, x)| (s + x, n + 1));
        if count as f64 * run.dt_s >= REST_S {
            means.insert(name.to_string(), sum / count as f64);
        }
    }
    means
}

/// Whether the longest stretch of one value of a channel is at its largest magnitude, give or take
/// 3 %: a low pass overshoots beside an end stop.
fn at_its_end(run: &Run, name: &str) -> bool {
    let pieces = run.columns.get(name).map(|x| run.gaps.within(x));
    let stretches = pieces.into_iter().flatten().map(|x| &x[longest_still(x)]);
    let still = stretches.max_by_key(|stretch| stretch.len());
    let value = still
        .and_then(|stretch| stretch.first())
        .map_or(0.0, |x| x.abs());
    let values = run.columns.get(name).into_iter().flatten();
    let largest = values.fold(0.0, |most: f64, x| most.max(x.abs()));
    value > 0.0 && value >= 0.97 * largest
}

/// Advice of notes.
const EMPTY_CELLS: &str = "empty those cells: a gap takes no part";
const RECORD_IT: &str = "record it, or leave the run out (--leave-out-bad-runs) where forces on the \
    runners are needed";
const NOTHING_FOR_GAPS: &str =
    "nothing: results are made without them; check the logger where it is much";
const LEAVE_OUT: &str = "leave the column out if nothing measures it";
const OWN_CLOCK: &str = "import it with its own clock and rate";
const LARGER_RANGE: &str = "a sensor with a larger range, or leave the run out";
const STATE_NOISE: &str = "state [noise] as the step over the root of 12";
const ALIGN: &str = "align the clocks when importing, or state delay_s in [tolerances]";
const TAKE_OFF: &str = "take it off when importing, or state gyro_bias_radps";

fn notes(run: &Run, channels: &BTreeMap<String, Profile>, length_s: f64, used_s: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut note = |column: &str, weight: f64, advice: &str, what: String| {
        notes.push(Note {
            column: column.to_string(),
            what,
            advice: advice.to_string(),
            weight,
        });
    };
    // Only those that every computation needs: errors name the other absent ones.
    let absent = |name: &&&str| !run.columns.contains_key(**name);
    for name in Needs::FORCES.columns.iter().filter(absent) {
        let what = "not recorded, and forces on the runners need it";
        note(name, 1.0, RECORD_IT, what.to_string());
    }
    let gone = 1.0 - used_s / length_s;
    if gone > 0.0 {
        let gaps = &run.gaps;
        let what = format!(
            "{:.2} % take no part: {} rows missing, {} samples at standstill, {} values missing",
            100.0 * gone,
            gaps.rows_missing,
            gaps.standstill,
            gaps.missing.values().sum::<usize>()
        );
        note("", gone, NOTHING_FOR_GAPS, what);
    }
    if run.gaps.jitter > 0.0 {
        let what = format!("rows up to {:.0} % of a step off", 100.0 * run.gaps.jitter);
        let advice = "nothing: rows are brought to even steps";
        note("t_s", 0.01 * run.gaps.jitter, advice, what);
    }
    for remark in &run.remarks {
        note("", 0.001, "nothing, or record it", remark.clone());
    }
    for (name, profile) in channels {
        let still = profile.longest_still_s;
        if still >= STILL_S && profile.rows_held.is_none() {
            if still >= 0.99 * length_s {
                let what = "one value throughout".to_string();
                note(name, still / length_s, LEAVE_OUT, what);
            } else if at_its_end(run, name) {
                let what =
                    format!("one value for {still:.2} s, at the end of its range: saturated?");
                note(name, (still / length_s).max(0.05), LARGER_RANGE, what);
            } else {
                let what = format!("one value for {still:.2} s");
                note(name, still / length_s, LEAVE_OUT, what);
            }
        }
        if let Some(rows) = profile.rows_held {
            let rate = run.rate_hz() / rows as f64;
            let what = format!("each value is repeated over {rows} rows: {rate:.1} Hz");
            note(name, 0.02, OWN_CLOCK, what);
        }
        if let Some(found) = profile.saturation {
            let what = format!(
                "{} samples at an end of its range, {}, {} of them in one stretch from {:.3} s on: saturated?",
                found.samples,
                found.at,
                found.longest,
                run.t0_s + found.begins as f64 * run.dt_s
            );
            let share = found.samples as f64 / run.len() as f64;
            note(name, share.max(0.05), LARGER_RANGE, what);
        }
        if profile.dropouts > 0 {
            let what = format!(
                "{} times one value for a moment, off all around it: it drops out",
                profile.dropouts
            );
            note(name, 0.1, EMPTY_CELLS, what);
        }
        if profile.leaps > 0 {
            let count = profile.leaps;
            let what = format!("{count} single values leap off their neighbours' line");
            note(name, 0.1, EMPTY_CELLS, what);
        }
        if let Some(quantum) = profile.quantum
            && profile.rows_held.is_none()
            && still < STILL_S
        {
            let what = format!("steps of {quantum:.2e}, larger than its noise");
            note(name, 0.005, STATE_NOISE, what);
        }
        if let Some([delay, error]) = profile.delay_s
            && delay.abs() > LATE_S.max(5.0 * error)
        {
            let [delay, error] = [delay, error].map(|time| 1e3 * time);
            let what = format!("is {delay:.0} +- {error:.0} ms later than the others");
            note(name, 0.2, ALIGN, what);
        }
        if let Some(bias) = profile.at_standstill.filter(|bias| bias.abs() > 2e-3) {
            let what = format!("{bias:.4} rad/s at standstill");
            note(name, 0.1, TAKE_OFF, what);
        }
    }
    notes
}
