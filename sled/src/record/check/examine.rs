//! Runs examined: what is provably wrong, what is odd, and what every channel is like.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use crate::column::COLUMNS;
use crate::columns::Columns;
use crate::columns::read_columns;
use crate::error::Error;
use crate::fault::Fault;
use crate::record::check::profile::Profile;
use crate::record::check::relations::judge::judge;
use crate::record::check::relations::rigid_body::Slow;
use crate::record::check::relations::rigid_body::delays;
use crate::record::files::{find_copy, read_run};
use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps};
use crate::record::index::{Entry, read_index};
use crate::record::needs::Needs;
use crate::record::run::Run;

/// What every run must have for the sled's lateral forces; the rest is judged where it is recorded.
const LEAST: [&str; 1] = ["v_mps"];
/// A stretch of one value [s] from which a channel is told to stand still.
const STILL_S: f64 = 0.5;
/// Standstill [s] whose mean tells a bias.
const REST_S: f64 = 1.0;
/// Delays [s] below this are not told, nor those below five standard errors: clean runs show 0.074 +- 0.020 for a quiet channel.
const LATE_S: f64 = 0.05;

/// Something odd that no one can prove wrong from the run alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
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

/// What is known of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Examination {
    /// Name of the run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// Why it cannot be used at all.
    pub refused: Option<String>,
    /// What is wrong, proved or suspected.
    pub faults: Vec<Fault>,
    /// What is odd, worst first.
    pub notes: Vec<Note>,
    /// What is not there.
    pub gaps: Gaps,
    /// Rows a second [Hz].
    pub rate_hz: f64,
    /// Length [s].
    pub length_s: f64,
    /// What takes part [s].
    pub used_s: f64,
    /// Every channel.
    pub channels: BTreeMap<String, Profile>,
}

impl Examination {
    /// Whether something is provably wrong.
    pub fn is_wrong(&self) -> bool {
        self.refused.is_some() || self.faults.iter().any(|fault| fault.proven)
    }
}

/// Examines every run of an index; the worst first, else in the index's order.
///
/// # Errors
/// Those of the index; what is wrong with a run is told of the run.
pub fn examine(index: &Path) -> Result<Vec<Examination>, Error> {
    let read: Vec<(Entry, Result<Run, Error>)> = read_index(index)?
        .into_par_iter()
        .map(|entry| (entry.clone(), read_run(entry, &LEAST, OnGaps::LeaveOut)))
        .collect();
    // Long recordings are held once: runs in one list, with their places in the index beside them.
    let (mut runs, mut places, mut examined) = (Vec::new(), Vec::new(), Vec::new());
    for (place, (entry, run)) in read.into_iter().enumerate() {
        match run {
            Ok(run) => {
                runs.push(run);
                places.push(place);
            }
            Err(error) => examined.push((place, refused(&entry, error.to_string()))),
        }
    }
    while let Some((first, second)) = find_copy(&runs) {
        let of = runs[first].entry.run.clone();
        let (copy, place) = (runs.remove(second), places.remove(second));
        let mut one = examine_run(&copy, Vec::new());
        one.refused = Some(format!(
            "holds the same samples as run {of}: expected each run once"
        ));
        examined.push((place, one));
    }
    let faults = judge(&runs);
    let found: Vec<(usize, Examination)> = runs
        .par_iter()
        .zip(places)
        .map(|(run, place)| {
            let own = faults.iter().filter(|fault| fault.run == run.entry.run);
            (place, examine_run(run, own.cloned().collect()))
        })
        .collect();
    examined.extend(found);
    examined.sort_by_key(|(place, _)| *place);
    let mut examined: Vec<Examination> = examined.into_iter().map(|(_, one)| one).collect();
    let rank = |one: &Examination| {
        let odd = one.notes.first().map_or(0.0, |note| note.weight);
        (
            one.refused.is_none(),
            std::cmp::Reverse(one.faults.len()),
            -odd,
        )
    };
    examined.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    });
    Ok(examined)
}

/// A run that cannot be used at all.
fn refused(entry: &Entry, reason: String) -> Examination {
    Examination {
        run: entry.run.clone(),
        file: entry.file.display().to_string(),
        refused: Some(reason),
        faults: Vec::new(),
        notes: Vec::new(),
        gaps: Gaps::default(),
        rate_hz: 0.0,
        length_s: 0.0,
        used_s: 0.0,
        channels: BTreeMap::new(),
    }
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
        let profile = Profile {
            missing: run.gaps.missing.get(*name).copied().unwrap_or(0),
            at_standstill: rest.get(*name).copied(),
            // Of a channel that is something else nothing is said.
            delay_s: delay
                .filter(|_| faults.is_empty())
                .map(|(delay, error)| [delay, error]),
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
        channels,
    }
}

/// Means of the gyroscopes while the speed stood at 0, from the file itself: a run is cut to where it moves.
fn at_rest(run: &Run) -> BTreeMap<String, f64> {
    let read = || -> Option<Columns> { read_columns(&run.entry.file, &[]).ok() };
    let mut means = BTreeMap::new();
    let cut = run.gaps.cut_s.iter().any(|cut| *cut >= REST_S) || run.gaps.standstill > 0;
    let Some(columns) = cut.then(read).flatten() else {
        return means;
    };
    let Some(speed) = columns.get("v_mps") else {
        return means;
    };
    for name in ["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"] {
        let Some(column) = columns.get(name) else {
            continue;
        };
        let still = speed
            .iter()
            .zip(column)
            .filter(|(v, x)| v.abs() <= LEAST_SPEED && x.is_finite());
        let (sum, count) = still.fold((0.0, 0_usize), |(s, n), (_, x)| (s + x, n + 1));
        if count as f64 * run.dt_s >= REST_S {
            means.insert(name.to_string(), sum / count as f64);
        }
    }
    means
}

fn notes(run: &Run, channels: &BTreeMap<String, Profile>, length_s: f64, used_s: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut note = |column: &str, what: String, advice: &str, weight: f64| {
        notes.push(Note {
            column: column.to_string(),
            what,
            advice: advice.to_string(),
            weight,
        });
    };
    // Only those that nothing computes without: what else is absent an error names.
    let absent = |name: &&&str| !run.columns.contains_key(**name);
    for name in Needs::FORCES.columns.iter().filter(absent) {
        let advice = "record it, or leave the run out (--leave-out-bad-runs) where forces on the runners are asked for";
        note(
            name,
            "not recorded, and forces on the runners need it".into(),
            advice,
            1.0,
        );
    }
    let gone = 1.0 - used_s / length_s;
    if gone > 0.0 {
        let gaps = &run.gaps;
        note(
            "",
            format!(
                "{:.2} % take no part: {} rows missing, {} samples at standstill, {} values missing",
                100.0 * gone,
                gaps.rows_missing,
                gaps.standstill,
                gaps.missing.values().sum::<usize>()
            ),
            "nothing: results are made without them; look at the logger where it is much",
            gone,
        );
    }
    if run.gaps.jitter > 0.0 {
        note(
            "t_s",
            format!("rows up to {:.0} % of a step off", 100.0 * run.gaps.jitter),
            "nothing: rows are brought to even steps",
            0.01 * run.gaps.jitter,
        );
    }
    for remark in &run.remarks {
        note("", remark.clone(), "nothing, or record it", 0.001);
    }
    for (name, profile) in channels {
        let still = profile.longest_still_s;
        if still >= STILL_S && profile.rows_held.is_none() {
            let all = still >= 0.99 * length_s;
            let what = if all {
                "one value throughout".to_string()
            } else {
                format!("one value for {still:.2} s")
            };
            note(
                name,
                what,
                "leave the column out if nothing measures it",
                still / length_s,
            );
        }
        if let Some(rows) = profile.rows_held {
            let rate = run.rate_hz() / rows as f64;
            let what = format!("each value stands for {rows} rows: {rate:.1} Hz");
            note(name, what, "import it with its own clock and rate", 0.02);
        }
        if let Some(found) = profile.saturation {
            let what = format!(
                "{} samples at an end of its range, {}, {} of them in one stretch from {:.3} s on: saturated?",
                found.samples,
                found.at,
                found.longest,
                run.t0_s + found.begins as f64 * run.dt_s
            );
            let advice = "a sensor with a larger range, or leave the run out";
            let share = found.samples as f64 / run.len() as f64;
            note(name, what, advice, share.max(0.05));
        }
        if profile.dropouts > 0 {
            let what = format!(
                "{} times one value for a moment, off all around it: it drops out",
                profile.dropouts
            );
            note(name, what, "empty those cells: a gap takes no part", 0.1);
        }
        if profile.leaps > 0 {
            let what = format!(
                "{} single values leap off their neighbours' line",
                profile.leaps
            );
            note(name, what, "empty those cells: a gap takes no part", 0.1);
        }
        if let Some(quantum) = profile
            .quantum
            .filter(|_| profile.rows_held.is_none() && still < STILL_S)
        {
            let what = format!("steps of {quantum:.2e}, larger than its noise");
            note(
                name,
                what,
                "state [noise] as the step over the root of 12",
                0.005,
            );
        }
        if let Some([delay, error]) = profile.delay_s
            && delay.abs() > LATE_S.max(5.0 * error)
        {
            let what = format!(
                "comes {:.0} +- {:.0} ms late beside the others",
                1e3 * delay,
                1e3 * error
            );
            note(
                name,
                what,
                "align the clocks when importing, or state delay_s in [tolerances]",
                0.2,
            );
        }
        if let Some(bias) = profile.at_standstill.filter(|bias| bias.abs() > 2e-3) {
            let what = format!("{bias:.4} rad/s at standstill");
            note(
                name,
                what,
                "take it off when importing, or state gyro_bias_radps",
                0.1,
            );
        }
    }
    notes
}
