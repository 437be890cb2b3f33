//! Faults of single channels: one value throughout, values repeated over many rows, magnitudes that
//! no sled reaches.

use crate::column::{COLUMNS, Sensor};
use crate::fault::{Fault, FaultKind};
use crate::record::gaps::rows_held;
use crate::record::run::Run;
use crate::series::median;

/// Channels that move together: where one moves and another has one value, that one does not
/// measure.
const TOGETHER: [&[Sensor]; 3] = [
    &[Sensor::Ay, Sensor::YawRate, Sensor::Slip],
    &[Sensor::Az, Sensor::PitchRate],
    &[Sensor::Ax, Sensor::Speed],
];

/// A step of the clock [s] in which a sled passes a curve.
const LONGEST_STEP_S: f64 = 0.5;

/// Rows of one value from which a channel is slower than its rows, where its own rate is below
/// twice the corner of the filters, 20 Hz.
const HELD_ROWS: usize = 5;

/// Twice the usual corner [Hz].
const LEAST_RATE_HZ: f64 = 40.0;

/// Faults of clock, constant channels and channels slower than their rows.
pub(super) fn plain_faults(run: &Run) -> Vec<Fault> {
    let mut faults = Vec::new();
    if run.dt_s >= LONGEST_STEP_S {
        let step = run.dt_s;
        let evidence = format!("a row every {step} s; good runs have one every 0.02 s or less");
        let (kind, mend) = (FaultKind::Clock, "unit = \"ms\" for the clock".to_owned());
        let milliseconds = "milliseconds";
        faults.push(Fault::proven(
            run,
            &["t_s"],
            kind,
            milliseconds,
            evidence,
            mend,
        ));
    }
    let one_value = |name: &str| {
        let mut values = run.gaps.within(run.columns.get(name)?).flatten();
        let first = values.next()?;
        values.all(|x| x == first).then_some(*first)
    };
    for group in TOGETHER {
        let names = group.iter().map(|sensor| sensor.name());
        let there = names.filter(|name| run.columns.contains_key(*name));
        let (still, moving): (Vec<&str>, Vec<&str>) =
            there.partition(|name| one_value(name).is_some());
        let Some(other) = moving.first() else {
            continue;
        };
        for name in still {
            let value = one_value(name).unwrap_or(0.0);
            let evidence = format!("{value} in every row, while {other} moves");
            faults.push(constant_fault(run, name, evidence));
        }
    }
    for name in COLUMNS {
        let column = run.columns.get(name);
        let Some(rows) = column.and_then(|x| rows_held(run.gaps.within(x))) else {
            continue;
        };
        let rate = run.rate_hz() / rows as f64;
        if rows >= HELD_ROWS && rate < LEAST_RATE_HZ {
            let values = format!("values of {rate:.4} Hz, each repeated over {rows} rows");
            let evidence = format!(
                "9 of 10 values or more are repeated so; filters at 20 Hz need {LEAST_RATE_HZ} Hz"
            );
            let mend =
                format!("import {name} from its own logger with its own clock ({rate:.4} Hz)");
            let fault = Fault::proven(run, &[name], FaultKind::Held, &values, evidence, mend);
            faults.push(fault.proven_if(false));
        }
    }
    faults
}

/// The fault of a channel with one value throughout.
pub(super) fn constant_fault(run: &Run, name: &str, evidence: String) -> Fault {
    let mend = format!("another source for {name}: this one does not measure");
    let values = "one value throughout";
    Fault::proven(run, &[name], FaultKind::Constant, values, evidence, mend)
}

/// Channels of a run that exceed their range; those with a fault already are skipped.
pub(super) fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let judged = |name: &str| known.iter().flat_map(|f| &f.columns).any(|c| c == name);
    let fault = |name: &'static str| {
        let column = run.columns.get(name).filter(|_| !judged(name))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (kind, looks_like, evidence, mend) = out_of_range(name, &values)?;
        let mend = format!("{mend} for {name}");
        let columns = [name];
        Some(Fault::proven(
            run, &columns, kind, looks_like, evidence, mend,
        ))
    };
    COLUMNS.into_iter().filter_map(fault).collect()
}

/// Largest magnitude of channels, their unit, and the unit in which they exceed it: in words, and
/// as a mapping states it.
type Range = (&'static [Sensor], f64, &'static str, [&'static str; 2]);

const ANGLE: &str = "radians";
const DEGREES: [&str; 2] = ["degrees", "deg"];
const TURN: &str = "radians per second";
const DEGREES_PER_SECOND: [&str; 2] = ["degrees per second", "deg/s"];
const FORCE: &str = "metres per second squared";
const UNKNOWN: [&str; 2] = ["a raw count or another unit", "..."];

const RANGES: [Range; 5] = [
    (&[Sensor::Slip, Sensor::RollSplit], 0.4, ANGLE, DEGREES),
    (&[Sensor::Steering], 0.6, ANGLE, DEGREES),
    (&Sensor::GYROSCOPE, 12.0, TURN, DEGREES_PER_SECOND),
    (&[Sensor::Speed], 70.0, "metres per second", ["km/h"; 2]),
    (&Sensor::ACCELEROMETER, 500.0, FORCE, UNKNOWN),
];

/// Kind, what the values seem to be, evidence and remedy of a channel out of its range.
fn out_of_range(column: &str, values: &[f64]) -> Option<(FaultKind, &'static str, String, String)> {
    let sensor = Sensor::named(column)?;
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // A sled that spins slips by up to half a turn for a while, but not for most of its run.
    let far = values.iter().filter(|v| v.abs() > 0.4).count();
    let spins = sensor == Sensor::Slip && largest <= std::f64::consts::PI && 4 * far < values.len();
    let range = RANGES.iter().find(|(of, ..)| of.contains(&sensor))?;
    let (_, most, own, [looks_like, unit]) = range;
    if largest > *most && !spins {
        let evidence =
            format!("largest magnitude {largest:.4}; expected {own}, magnitudes below {most}");
        let mend = format!("unit = \"{unit}\"");
        return Some((FaultKind::Unit, looks_like, evidence, mend));
    }
    if sensor != Sensor::Az {
        return None;
    }
    let median = median(values.iter().copied())?;
    let evidence = format!(
        "median {median:.3}; expected metres per second squared, +9.81 at rest on level ice"
    );
    if (0.5..4.5).contains(&median.abs()) {
        let mend = "unit = \"g\"".to_owned();
        return Some((FaultKind::Unit, "multiples of g", evidence, mend));
    }
    let down = "an axis that points down";
    (median < 0.0).then(|| (FaultKind::Sign, down, evidence, "sign = -1".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slip_in_a_spin_is_no_angle_in_degrees() {
        let slip = |share: usize, size: f64| -> Vec<f64> {
            (0..100)
                .map(|i| if i < share { size } else { 0.02 })
                .collect()
        };
        assert!(out_of_range("alpha_rad", &slip(20, 3.1)).is_none());
        assert!(out_of_range("alpha_rad", &slip(60, 2.0)).is_some());
        assert!(out_of_range("alpha_rad", &slip(5, 40.0)).is_some());
    }
}
