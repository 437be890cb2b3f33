//! Faults of single channels: one value throughout, values repeated over many rows, magnitudes that
//! no sled reaches.

use crate::column::{COLUMNS, Sensor};
use crate::fault::Fault;
use crate::record::check::remedies::{DEGREES, DEGREES_PER_SECOND, G, KM_PER_HOUR, Mend, Unit};
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
        faults.push(Fault::proven(run, &["t_s"], Mend::Clock, evidence));
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
            faults.push(Fault::proven(run, &[name], Mend::Replace, evidence));
        }
    }
    for name in COLUMNS {
        let column = run.columns.get(name);
        let Some(rows) = column.and_then(|x| rows_held(run.gaps.within(x))) else {
            continue;
        };
        let rate = run.rate_hz() / rows as f64;
        if rows >= HELD_ROWS && rate < LEAST_RATE_HZ {
            let evidence = format!(
                "9 of 10 values or more are repeated so; filters at 20 Hz need {LEAST_RATE_HZ} Hz"
            );
            let fault = Fault::proven(run, &[name], Mend::OwnClock(rate, rows), evidence);
            faults.push(fault.proven_if(false));
        }
    }
    faults
}

/// Channels of a run that exceed their range; those with a fault already are skipped.
pub(super) fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let judged = |name: &str| known.iter().flat_map(|f| &f.columns).any(|c| c == name);
    let fault = |name: &'static str| {
        let column = run.columns.get(name).filter(|_| !judged(name))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (mend, evidence) = out_of_range(name, &values)?;
        Some(Fault::proven(run, &[name], mend, evidence))
    };
    COLUMNS.into_iter().filter_map(fault).collect()
}

/// Largest magnitude of channels, their unit in words, and the unit in which they exceed it.
type Range = (&'static [Sensor], f64, &'static str, Unit);

const ANGLE: &str = "radians";
const UNKNOWN: Unit = ("a raw count or another unit", "...", f64::NAN);

const RANGES: [Range; 5] = [
    (&[Sensor::Slip, Sensor::RollSplit], 0.4, ANGLE, DEGREES),
    (&[Sensor::Steering], 0.6, ANGLE, DEGREES),
    (
        &Sensor::GYROSCOPE,
        12.0,
        "radians per second",
        DEGREES_PER_SECOND,
    ),
    (&[Sensor::Speed], 70.0, "metres per second", KM_PER_HOUR),
    (
        &Sensor::ACCELEROMETER,
        500.0,
        "metres per second squared",
        UNKNOWN,
    ),
];

/// Remedy and evidence of a channel out of its range.
fn out_of_range(column: &str, values: &[f64]) -> Option<(Mend, String)> {
    let sensor = Sensor::named(column)?;
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // A sled that spins slips by up to half a turn for a while, but not for most of its run.
    let far = values.iter().filter(|v| v.abs() > 0.4).count();
    let spins = sensor == Sensor::Slip && largest <= std::f64::consts::PI && 4 * far < values.len();
    let range = RANGES.iter().find(|(of, ..)| of.contains(&sensor))?;
    let (_, most, own, unit) = range;
    if largest > *most && !spins {
        let evidence =
            format!("largest magnitude {largest:.4}; expected {own}, magnitudes below {most}");
        return Some((Mend::Convert(*unit), evidence));
    }
    if sensor != Sensor::Az {
        return None;
    }
    let median = median(values.iter().copied())?;
    let evidence = format!(
        "median {median:.3}; expected metres per second squared, +9.81 at rest on level ice"
    );
    if (0.5..4.5).contains(&median.abs()) {
        return Some((Mend::Convert(G), evidence));
    }
    (median < 0.0).then_some((Mend::Negate, evidence))
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
