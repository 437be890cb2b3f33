//! Examination of recorded runs: faults, notes, and the profile of every channel.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use crate::column::Sensor;
use crate::columns::read_columns;
use crate::error::Error;
use crate::fault::Fault;
use crate::record::check::faults::find_faults;
use crate::record::check::profile::{
    OddKind, OddSamples, OddStretch, Profile, describe_odd_samples,
};
use crate::record::check::relations::{SlowChannels, delay};
use crate::record::files::{copies, read_run};
use crate::record::gaps::{Gaps, LEAST_SPEED, OnGaps};
use crate::record::index::{Entry, read_index};
use crate::record::needs::Needs;
use crate::record::run::Run;

/// Columns that every run must have; the others are examined if they are recorded.
const REQUIRED: [&str; 1] = ["v_mps"];
/// Shortest constant stretch that is reported [s].
const MIN_STILL_S: f64 = 0.5;
/// Most stretches of a channel that are listed; its profile counts them all.
const MAX_STRETCHES: usize = 100;
/// Shortest standstill that determines a bias [s].
const MIN_REST_S: f64 = 1.0;
/// Smallest delay that is reported [s], if it also exceeds five standard errors: clean runs show
/// 0.27 +- 0.14 for a channel with a weak signal.
const MIN_DELAY_S: f64 = 0.05;

/// An observation that may have a harmless cause and is therefore no fault.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Note {
    /// The channel; empty for the whole run.
    pub column: String,
    /// The observation.
    pub what: String,
    /// What to do.
    pub advice: String,
    /// About the share of the run that is affected; larger is worse.
    pub weight: f64,
}

/// Faults, notes and channels of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Examination {
    /// Name of the run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// Why the run cannot be used.
    pub refused: Option<String>,
    /// Faults, proved or suspected.
    pub faults: Vec<Fault>,
    /// Notes, the worst first.
    pub notes: Vec<Note>,
    /// Gaps.
    pub gaps: Gaps,
    /// Sampling rate [Hz].
    pub rate_hz: f64,
    /// Duration [s].
    pub length_s: f64,
    /// Time that is used [s].
    pub used_s: f64,
    /// The profile of every channel, by name.
    pub channels: BTreeMap<String, Profile>,
    /// Where channels are odd.
    pub stretches: Vec<OddStretch>,
}

impl Examination {
    /// Whether the run cannot be used or has a proven fault.
    pub fn is_wrong(&self) -> bool {
        self.refused.is_some() || self.faults.iter().any(|fault| fault.proven)
    }
}

/// Examines every run of an index: the worst first, else in the order of the index. The run is
/// absent if it cannot be read.
///
/// # Errors
/// Those of the index. Errors of a run are in its examination.
pub fn examine(index: &Path) -> Result<Vec<(Examination, Option<Run>)>, Error> {
    let read = |entry: Entry| (entry.clone(), read_run(entry, &REQUIRED, OnGaps::LeaveOut));
    let read: Vec<_> = read_index(index)?.into_par_iter().map(read).collect();
    let runs: Vec<&Run> = read.iter().flat_map(|(_, run)| run).collect();
    let name = |run: usize| runs[run].entry.run.clone();
    let copied: BTreeMap<String, String> = copies(&runs)
        .into_iter()
        .map(|(first, second)| (name(second), name(first)))
        .collect();
    let is_original = |run: &&Run| !copied.contains_key(&run.entry.run);
    let originals = runs.into_iter().filter(is_original);
    let faults = find_faults(&originals.collect::<Vec<_>>());
    let examine_one = |(entry, read): (Entry, Result<Run, Error>)| match read {
        Err(error) => {
            let refused = Examination {
                run: entry.run,
                file: entry.file.display().to_string(),
                refused: Some(error.to_string()),
                ..Examination::default()
            };
            (refused, None)
        }
        Ok(run) => {
            let own = faults.iter().filter(|fault| fault.run == run.entry.run);
            let mut one = examine_run(&run, own.cloned().collect());
            let of = copied.get(&one.run);
            one.refused =
                of.map(|of| format!("holds the same samples as run {of}: expected each run once"));
            (one, Some(run))
        }
    };
    let mut examined: Vec<(Examination, Option<Run>)> =
        read.into_par_iter().map(examine_one).collect();
    let max_weight = |one: &Examination| one.notes.first().map_or(0.0, |note| note.weight);
    let rank = |one: &Examination| (one.refused.is_some(), one.faults.len());
    examined.sort_by(|(a, _), (b, _)| {
        let by_fault = rank(b).cmp(&rank(a));
        by_fault.then(max_weight(b).total_cmp(&max_weight(a)))
    });
    Ok(examined)
}

fn examine_run(run: &Run, faults: Vec<Fault>) -> Examination {
    let rate_hz = run.rate_hz();
    let biases = biases_at_rest(run);
    // Faults of other channels would appear as delays.
    let slow = SlowChannels::of(run).filter(|_| faults.is_empty());
    let used: usize = run.gaps.pieces.iter().map(Range::len).sum();
    let (length_s, used_s) = (run.len() as f64 * run.dt_s, used as f64 * run.dt_s);
    let stretch = |column: &str, kind, samples: Range<usize>| OddStretch {
        column: column.to_owned(),
        kind,
        from_s: run.t0_s + samples.start as f64 * run.dt_s,
        to_s: run.t0_s + (samples.end - 1) as f64 * run.dt_s,
    };
    let between = run.gaps.pieces.windows(2);
    let gaps = between.map(|pair| stretch("", OddKind::Gap, pair[0].end..pair[1].start));
    let mut stretches: Vec<OddStretch> = gaps.take(MAX_STRETCHES).collect();
    let mut notes = run_notes(run, length_s, used_s);
    let mut channels = BTreeMap::new();
    for sensor in Sensor::ALL {
        let name = sensor.name();
        let Some(column) = run.columns.get(name) else {
            continue;
        };
        let (profile, odd) = Profile::of(column, &run.gaps.pieces, rate_hz);
        let delay = slow.as_ref().and_then(|slow| delay(slow, sensor));
        let profile = Profile {
            missing: run.gaps.missing.get(name).copied().unwrap_or(0),
            at_standstill: biases.get(name).copied(),
            delay_s: delay.map(<[f64; 2]>::from),
            saturation: run.saturated.get(name).copied(),
            ..profile
        };
        notes.extend(channel_notes(run, name, &profile, &odd, length_s));
        let stop = profile.saturation.iter();
        let stop = stop.map(|stop| (OddKind::Saturated, stop.begins..stop.begins + stop.longest));
        let is_long = |one: &OddSamples| one.samples.len() as f64 * run.dt_s > MIN_STILL_S;
        let listed = odd
            .into_iter()
            .filter(|one| one.is_implausible() || is_long(one));
        let listed = stop.chain(listed.map(|one| (one.kind, one.samples)));
        let listed = listed.take(MAX_STRETCHES);
        stretches.extend(listed.map(|(kind, samples)| stretch(name, kind, samples)));
        channels.insert(name.to_owned(), profile);
    }
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
        stretches,
        channels,
    }
}

/// Means of the gyroscope's axes while the speed was 0, by column. They are read from the file, since
/// the run itself is cut to the samples in motion.
fn biases_at_rest(run: &Run) -> BTreeMap<String, f64> {
    let mut means = BTreeMap::new();
    if run.gaps.cut_s.iter().all(|cut| *cut < MIN_REST_S) && run.gaps.standstill == 0 {
        return means;
    }
    let columns = read_columns(&run.entry.file, &[])
        .unwrap_or_default()
        .columns;
    let Some(speed) = columns.get("v_mps") else {
        return means;
    };
    for name in Sensor::GYROSCOPE.map(Sensor::name) {
        let pairs = speed.iter().zip(columns.get(name).into_iter().flatten());
        let at_rest = pairs.filter(|(v, x)| v.abs() <= LEAST_SPEED && x.is_finite());
        let (sum, count) = at_rest.fold((0.0, 0.0), |(sum, count), (_, x)| (sum + x, count + 1.0));
        if count * run.dt_s >= MIN_REST_S {
            means.insert(name.to_string(), sum / count);
        }
    }
    means
}

/// Advice of several notes.
const LEAVE_OUT: &str = "leave the column out if nothing measures it";
const LARGER_RANGE: &str = "a sensor with a larger range, or leave the run out";

impl Note {
    fn new(column: &str, weight: f64, advice: &str, what: String) -> Note {
        Note {
            column: column.to_owned(),
            what,
            advice: advice.to_owned(),
            weight,
        }
    }
}

/// Notes on the whole run.
fn run_notes(run: &Run, length_s: f64, used_s: f64) -> Vec<Note> {
    let gaps = &run.gaps;
    // An error names other absent columns when a computation needs them.
    let needed = Needs::FORCES.columns.iter();
    let absent = needed.filter(|name| !run.columns.contains_key(**name));
    let what = "not recorded, and forces on the runners need it";
    let advice = "record it, or leave the run out (--leave-out-bad-runs) where forces on the \
        runners are needed";
    let mut notes: Vec<Note> = absent
        .map(|name| Note::new(name, 1.0, advice, what.to_owned()))
        .collect();
    let unused = 1.0 - used_s / length_s;
    if unused > 0.0 {
        let what = format!(
            "{:.2} % are not used: {} rows missing, {} samples at standstill, {} values missing",
            100.0 * unused,
            gaps.rows_missing,
            gaps.standstill,
            gaps.missing.values().sum::<usize>()
        );
        let advice = "nothing: results are made without them; check the logger where it is much";
        notes.push(Note::new("", unused, advice, what));
    }
    if gaps.jitter > 0.0 {
        let what = format!("rows up to {:.0} % of a step off", 100.0 * gaps.jitter);
        let advice = "nothing: rows are brought to even steps";
        notes.push(Note::new("t_s", 0.01 * gaps.jitter, advice, what));
    }
    let remarks = run.remarks.iter().cloned();
    notes.extend(remarks.map(|what| Note::new("", 0.001, "nothing, or record it", what)));
    notes.extend(distance_note(run));
    notes
}

/// A note on a speed whose integral differs from the recorded distance; `None` for a distance that
/// restarts.
fn distance_note(run: &Run) -> Option<Note> {
    /// Largest relative difference: runs leave the middle of the track by a few per cent.
    const MAX_DIFFERENCE: f64 = 0.04;
    let s_m = run.columns.get("s_m")?;
    let recorded = s_m.last()? - s_m.first()?;
    let travelled = run.travelled_m(run.len() - 1)?;
    let difference = travelled / recorded - 1.0;
    let restarts = s_m.windows(2).any(|pair| pair[1] < pair[0] - 1.0);
    (difference.abs() > MAX_DIFFERENCE && difference.abs() < 0.5 && !restarts).then(|| {
        let what = format!(
            "adds up to {travelled:.1} m, and s_m to {recorded:.1} m: {:+.1} %",
            100.0 * difference
        );
        let advice = "calibrate the speed, or correct s_m";
        Note::new("v_mps", difference.abs(), advice, what)
    })
}

/// Notes on a channel.
fn channel_notes(
    run: &Run,
    name: &str,
    profile: &Profile,
    odd: &[OddSamples],
    length_s: f64,
) -> Vec<Note> {
    let column = &run.columns[name];
    let constant = odd.iter().filter(|one| one.kind == OddKind::Still);
    let longest = constant.max_by_key(|one| one.samples.len());
    let value = longest.map_or(0.0, |one| column[one.samples.start].abs());
    let largest = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    // 3 % less than the largest magnitude: a low pass overshoots next to an end stop.
    let is_at_end = value > 0.0 && value >= 0.97 * largest;
    let described = describe_odd_samples(run, column, odd);
    let is_frozen = described.iter().any(|(kind, _)| *kind == OddKind::Still);
    let mut notes = Vec::new();
    let mut note = |weight: f64, advice: &str, what: String| {
        notes.push(Note::new(name, weight, advice, what));
    };
    let still = profile.longest_still_s;
    let share = still / length_s;
    if let Some(rows) = profile.rows_held {
        let rate = run.rate_hz() / rows as f64;
        let what = format!("each value is repeated over {rows} rows: {rate:.1} Hz");
        note(0.02, "import it with its own clock and rate", what);
    } else if still >= MIN_STILL_S.max(0.99 * length_s) {
        note(share, LEAVE_OUT, "one value throughout".to_owned());
    } else if still >= MIN_STILL_S && is_at_end {
        let what = format!("one value for {still:.2} s, at the end of its range: saturated?");
        note(share.max(0.05), LARGER_RANGE, what);
    } else if still >= MIN_STILL_S && !is_frozen {
        note(share, LEAVE_OUT, format!("one value for {still:.2} s"));
    } else if let Some(quantum) = profile.quantum {
        let what = format!("steps of {quantum:.2e}, larger than its noise");
        note(0.005, "state [noise] as the step over the root of 12", what);
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
        note(share.max(0.05), LARGER_RANGE, what);
    }
    for (kind, what) in described {
        // A constant value at the end of the range is noted above.
        if !is_at_end || kind != OddKind::Still {
            note(share.max(0.1), "empty those cells: a gap is not used", what);
        }
    }
    if let Some([delay, error]) = profile.delay_s
        && delay.abs() > MIN_DELAY_S.max(5.0 * error)
    {
        let [delay, error] = [delay, error].map(|time| 1e3 * time);
        let what = format!("is {delay:.0} +- {error:.0} ms later than the others");
        let advice = "align the clocks when importing, or state delay_s in [tolerances]";
        note(0.2, advice, what);
    }
    if let Some(bias) = profile.at_standstill.filter(|bias| bias.abs() > 2e-3) {
        let advice = "take it off when importing, or state gyro_bias_radps";
        note(0.1, advice, format!("{bias:.4} rad/s at standstill"));
    }
    notes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::path::Path;

    use super::*;

    /// A run of a sine at 100 Hz with a leap, a drop-out, a still stretch and a gap.
    fn run(folder: &Path) -> Run {
        let file = folder.join("a.csv");
        std::fs::write(folder.join("runs.csv"), "run,file\na,a.csv\n").expect("a folder");
        let mut text = String::from("t_s,v_mps,yaw_rate_radps\n");
        for i in 0..1000 {
            let t = 0.01 * f64::from(i);
            // Noise of which no two values are equal.
            let noise = 1e-2 * (f64::from(i * i % 97) / 97.0 - 0.5);
            let yaw = match i {
                200 => 9.0,
                400..=403 => -9.0,
                600..=699 => 0.25,
                800..=819 => f64::NAN,
                _ => (0.3 * t).sin() + noise,
            };
            text += &format!("{t},{},{yaw}\n", 20.0 + noise);
        }
        std::fs::write(&file, text).expect("a folder");
        let entry = read_index(&folder.join("runs.csv"))
            .expect("an index")
            .remove(0);
        let mut columns = read_columns(&file, &["v_mps", "yaw_rate_radps"])
            .expect("columns")
            .columns;
        columns.remove("t_s");
        let gaps = Gaps::find(&mut columns, &["v_mps", "yaw_rate_radps"], 0.01);
        Run {
            entry,
            t0_s: 5.0,
            dt_s: 0.01,
            columns,
            gaps,
            saturated: BTreeMap::new(),
            remarks: Vec::new(),
        }
    }

    #[test]
    fn odd_stretches_are_where_they_were_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let run = run(folder.path());
        let found = examine_run(&run, Vec::new()).stretches;
        let expected = [
            ("", OddKind::Gap, 13.0, 13.19),
            ("yaw_rate_radps", OddKind::Leap, 7.0, 7.0),
            ("yaw_rate_radps", OddKind::DropOut, 9.0, 9.03),
            ("yaw_rate_radps", OddKind::Still, 11.0, 11.99),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (stretch, (column, kind, from_s, to_s)) in found.iter().zip(expected) {
            assert_eq!((stretch.column.as_str(), stretch.kind), (column, kind));
            assert!((stretch.from_s - from_s).abs() < 1e-9, "{stretch:?}");
            assert!((stretch.to_s - to_s).abs() < 1e-9, "{stretch:?}");
        }
    }
}
