//! Faults of single channels: constant values, values repeated over many rows, magnitudes that no
//! sled reaches.

use std::f64::consts::PI;

use crate::column::{COLUMNS, Sensor};
use crate::fault::{Fault, FaultKind};
use crate::record::check::corrections::{
    DEGREES, DEGREES_PER_SECOND, G, KM_PER_HOUR, OTHER_SIGN, SPIKES, Scale, UNKNOWN,
};
use crate::record::gaps::rows_held;
use crate::record::run::Run;
use crate::series::median;

/// Channels that vary together: if one varies, a constant one does not measure.
const COUPLED: [&[Sensor]; 4] = [
    &[Sensor::Ay, Sensor::YawRate, Sensor::Slip],
    &[Sensor::Az, Sensor::PitchRate],
    &[Sensor::Ax, Sensor::Speed],
    &[Sensor::YawRate, Sensor::RollRate],
];

/// Time step [s] in which a sled passes a curve: a clock with this step or a longer one has another
/// unit.
const MAX_STEP_S: f64 = 0.5;

/// A channel is too slow if each value is repeated over this number of rows or more, and its own
/// rate is below [`MIN_RATE_HZ`].
const MIN_HELD_ROWS: usize = 5;
/// Twice the usual cutoff frequency of the filters [Hz].
const MIN_RATE_HZ: f64 = 40.0;

/// Faults of clock, constant channels and channels slower than their rows.
pub(super) fn plain_faults(run: &Run) -> Vec<Fault> {
    let mut faults = Vec::new();
    if run.dt_s >= MAX_STEP_S {
        let step = run.dt_s;
        let evidence = format!("a row every {step} s; good runs have one every 0.02 s or less");
        let mend = "unit = \"ms\" for the clock".to_owned();
        let (kind, looks_like) = (FaultKind::Clock, "milliseconds");
        faults.push(Fault::proven(
            run,
            &["t_s"],
            kind,
            looks_like,
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
    for group in COUPLED {
        let names = group.iter().map(|sensor| sensor.name());
        let recorded = names.filter(|name| run.columns.contains_key(*name));
        let (constants, varying): (Vec<&str>, Vec<&str>) =
            recorded.partition(|name| constant(name).is_some());
        for name in constants {
            let (Some(value), Some(other)) = (constant(name), varying.first()) else {
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
        if rows >= MIN_HELD_ROWS && rate < MIN_RATE_HZ {
            let evidence = format!(
                "9 of 10 values or more are repeated so; filters at 20 Hz need {MIN_RATE_HZ} Hz"
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

/// Channels of a run that exceed their range, without those that have a `known` fault.
pub(super) fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let is_known = |name: &str| known.iter().flat_map(|f| &f.columns).any(|c| c == name);
    let fault = |sensor: Sensor| {
        let column = run.columns.get(sensor.name());
        let column = column.filter(|_| !is_known(sensor.name()))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (scale, evidence) = out_of_range(sensor, &values)?;
        Some(scale.fault(run, &[sensor.name()], evidence))
    };
    Sensor::ALL.into_iter().filter_map(fault).collect()
}

/// Channels, their largest magnitude, their unit in words, and the likely wrong unit of a channel
/// that exceeds it.
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

/// Wrong unit or sign of a channel, by its magnitudes, with the evidence.
fn out_of_range(sensor: Sensor, values: &[f64]) -> Option<(Scale, String)> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    // A sled that spins slips by up to half a turn for a while, but not for most of its run.
    let large = values.iter().filter(|v| v.abs() > 0.4).count();
    let is_spin = sensor == Sensor::Slip && largest <= PI && 4 * large < values.len();
    let (_, most, unit, scale) = RANGES.iter().find(|(of, ..)| of.contains(&sensor))?;
    if largest > *most && !is_spin {
        let above = values.iter().filter(|v| v.abs() > *most).count();
        let evidence = format!(
            "largest magnitude {largest:.4}, {above} of {} values; expected {unit}, magnitudes below {most}",
            values.len()
        );
        // A wrong unit affects more than single values.
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
        let fault = |share, size| out_of_range(Sensor::Slip, &slip(share, size));
        assert!(fault(20, 3.1).is_none());
        assert!(fault(60, 2.0).is_some());
        assert!(fault(5, 40.0).is_some());
    }
}
