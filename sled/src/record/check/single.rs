//! Faults of single channels: one value throughout, values repeated over many rows, magnitudes that
//! no sled reaches.

use std::f64::consts::PI;

use crate::column::{COLUMNS, Sensor};
use crate::fault::{Fault, FaultKind};
use crate::record::check::corrections::{
    DEGREES, DEGREES_PER_SECOND, G, KM_PER_HOUR, OTHER_SIGN, SPIKES, Scale, UNKNOWN,
};
use crate::record::gaps::rows_held;
use crate::record::run::Run;
use crate::series::median;

/// Channels that move together: where one moves and another has one value, that one does not
/// measure.
const TOGETHER: [&[Sensor]; 4] = [
    &[Sensor::Ay, Sensor::YawRate, Sensor::Slip],
    &[Sensor::Az, Sensor::PitchRate],
    &[Sensor::Ax, Sensor::Speed],
    &[Sensor::YawRate, Sensor::RollRate],
];

/// A step of the clock [s] in which a sled passes a curve.
const LONGEST_STEP_S: f64 = 0.5;

/// Rows of one value from which a channel is slower than its rows, where its own rate is below
/// twice the usual corner of the filters, 20 Hz.
const HELD_ROWS: usize = 5;
const LEAST_RATE_HZ: f64 = 40.0;

/// Faults of clock, constant channels and channels slower than their rows.
pub(super) fn plain_faults(run: &Run) -> Vec<Fault> {
    let mut faults = Vec::new();
    if run.dt_s >= LONGEST_STEP_S {
        let step = run.dt_s;
        let evidence = format!("a row every {step} s; good runs have one every 0.02 s or less");
        let mend = "unit = \"ms\" for the clock".to_owned();
        let kind = FaultKind::Clock;
        faults.push(Fault::proven(
            run,
            &["t_s"],
            kind,
            "milliseconds",
            mend,
            evidence,
        ));
    }
    let values = |name: &str| Some(run.gaps.within(run.columns.get(name)?).flatten());
    let constant = |name: &str| {
        let mut values = values(name)?;
        let first = values.next()?;
        values.all(|x| x == first).then_some(*first)
    };
    for group in TOGETHER {
        let names = group.iter().map(|sensor| sensor.name());
        let recorded = names.filter(|name| run.columns.contains_key(*name));
        let (still, moving): (Vec<&str>, Vec<&str>) =
            recorded.partition(|name| constant(name).is_some());
        for name in still {
            let (Some(value), Some(other)) = (constant(name), moving.first()) else {
                continue;
            };
            let evidence = format!("{value} in every row, while {other} moves");
            let mend = format!("another source for {name}: this one does not measure");
            let kind = FaultKind::Constant;
            let looks_like = "one value throughout";
            let fault = Fault::proven(run, &[name], kind, looks_like, mend, evidence);
            // A sled on a level track does not roll.
            faults.push(fault.proven_if(name != Sensor::RollRate.name()));
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
            let looks_like = format!("values of {rate:.4} Hz, each repeated over {rows} rows");
            let clock = format!("its own clock ({rate:.4} Hz)");
            let mend = format!("import {name} from its own logger with {clock}");
            let kind = FaultKind::Held;
            let fault = Fault::proven(run, &[name], kind, &looks_like, mend, evidence);
            faults.push(fault.proven_if(false));
        }
    }
    faults
}

/// Channels of a run that exceed their range; those with a fault already are skipped.
pub(super) fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let judged = |name: &str| known.iter().flat_map(|f| &f.columns).any(|c| c == name);
    let fault = |sensor: Sensor| {
        let column = run.columns.get(sensor.name());
        let column = column.filter(|_| !judged(sensor.name()))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (scale, evidence) = out_of_range(sensor, &values)?;
        Some(scale.fault(run, &[sensor.name()], evidence))
    };
    Sensor::ALL.into_iter().filter_map(fault).collect()
}

/// Channels, their largest magnitude, their unit in words, and what they are in where they exceed
/// it.
const RANGES: [(&[Sensor], f64, &str, Scale); 5] = [
    (&[Sensor::Slip, Sensor::RollSplit], 0.4, "radians", DEGREES),
    (&[Sensor::Steering], 0.6, "radians", DEGREES),
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

/// Scale and evidence of a channel out of its range.
fn out_of_range(sensor: Sensor, values: &[f64]) -> Option<(Scale, String)> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // A sled that spins slips by up to half a turn for a while, but not for most of its run.
    let far = values.iter().filter(|v| v.abs() > 0.4).count();
    let spins = sensor == Sensor::Slip && largest <= PI && 4 * far < values.len();
    let range = RANGES.iter().find(|(of, ..)| of.contains(&sensor))?;
    let (_, most, own, scale) = range;
    if largest > *most && !spins {
        let above = values.iter().filter(|v| v.abs() > *most).count();
        let evidence = format!(
            "largest magnitude {largest:.4}, {above} of {} values; expected {own}, magnitudes below {most}",
            values.len()
        );
        // In another unit more than single values are far off.
        let is_unit = 20 * above >= values.len();
        return Some((if is_unit { *scale } else { SPIKES }, evidence));
    }
    let median = median(values.iter().copied()).filter(|_| sensor == Sensor::Az)?;
    let scale = match median {
        _ if (0.5..4.5).contains(&median.abs()) => G,
        ..0.0 => OTHER_SIGN,
        _ => return None,
    };
    let evidence = format!(
        "median {median:.3}; expected metres per second squared, +9.81 at rest on level ice"
    );
    Some((scale, evidence))
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
        let judged = |share, size| out_of_range(Sensor::Slip, &slip(share, size));
        assert!(judged(20, 3.1).is_none());
        assert!(judged(60, 2.0).is_some());
        assert!(judged(5, 40.0).is_some());
    }
}
