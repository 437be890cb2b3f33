//! What one channel proves by itself: one value throughout, values held over many rows, a clock without a sled in it.

use crate::record::check::relations::fault::{Fault, FaultKind};
use crate::record::run::{COLUMNS, Run};

/// Channels that move together: where one does and another has but one value, that one does not measure.
const TOGETHER: [&[&str]; 3] = [
    &["ay_mps2", "yaw_rate_radps", "alpha_rad"],
    &["az_mps2", "pitch_rate_radps"],
    &["ax_mps2", "v_mps"],
];
/// A step of the clock [s] in which a sled passes a curve.
const LONGEST_STEP_S: f64 = 0.5;
/// Rows for one value from which a channel is held, where its own rate is below twice the corner of the filters, 20 Hz.
const HELD_ROWS: usize = 5;
/// Twice the usual corner [Hz].
const LEAST_RATE_HZ: f64 = 40.0;
/// Share of the values that must be held for the usual number of rows, give or take one: quantised values are not.
const EVENLY: f64 = 0.9;

/// What single channels of a run prove.
pub fn plain_faults(run: &Run) -> Vec<Fault> {
    let told = |column: &str, kind, looks_like: String, evidence: String, mend: String| Fault {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        columns: vec![column.to_string()],
        kind,
        looks_like,
        evidence,
        mend,
    };
    let mut faults = Vec::new();
    if run.dt_s >= LONGEST_STEP_S {
        faults.push(told(
            "t_s",
            FaultKind::Clock,
            "milliseconds".to_string(),
            format!(
                "a row every {} s; good runs have one every 0.02 s or less",
                run.dt_s
            ),
            "unit = \"ms\" for the clock".to_string(),
        ));
    }
    let one_value = |name: &str| {
        let mut values = run.gaps.within(run.columns.get(name)?).flatten();
        let first = values.next()?;
        values.all(|x| x == first).then_some(*first)
    };
    for group in TOGETHER {
        let there = group.iter().filter(|name| run.columns.contains_key(**name));
        let (still, moving): (Vec<&str>, Vec<&str>) =
            there.partition(|name| one_value(name).is_some());
        if let Some(other) = moving.first() {
            faults.extend(still.iter().map(|name| {
                told(
                    name,
                    FaultKind::Constant,
                    "one value throughout".to_string(),
                    format!(
                        "{} in every row, while {other} moves",
                        one_value(name).unwrap_or(0.0)
                    ),
                    format!("another source for {name}: this one does not measure"),
                )
            }));
        }
    }
    for name in COLUMNS {
        if let Some(rows) = run
            .columns
            .get(name)
            .and_then(|x| rows_held(run.gaps.within(x)))
            && rows >= HELD_ROWS
            && run.rate_hz() / (rows as f64) < LEAST_RATE_HZ
        {
            let rate = run.rate_hz() / rows as f64;
            faults.push(told(
                name,
                FaultKind::Held,
                format!("values of {rate:.4} Hz, each held for {rows} rows"),
                format!(
                    "9 of 10 values or more are held so; filters at 20 Hz need {LEAST_RATE_HZ} Hz"
                ),
                format!("import {name} from its own logger with its own clock ({rate:.4} Hz)"),
            ));
        }
    }
    faults
}

/// For how many rows each value stands, where nearly all stand for the same number, and for more than one.
pub fn rows_held<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<usize> {
    const FEWEST: usize = 20;
    let mut lengths = Vec::new();
    for stretch in stretches {
        let mut since: Option<usize> = None;
        for i in 1..stretch.len() {
            if stretch[i] != stretch[i - 1] {
                lengths.extend(since.map(|since| i - since));
                since = Some(i);
            }
        }
    }
    if lengths.len() < FEWEST {
        return None;
    }
    let middle = lengths.len() / 2;
    let usual = *lengths.select_nth_unstable(middle).1;
    let even = lengths
        .iter()
        .filter(|length| length.abs_diff(usual) <= 1)
        .count();
    (usual > 1 && even as f64 >= EVENLY * lengths.len() as f64).then_some(usual)
}
