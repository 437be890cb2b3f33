//! What one channel proves by itself: one value throughout, values held over many rows, a size that no sled reaches.

use crate::column::COLUMNS;
use crate::fault::{Fault, FaultKind};
use crate::record::run::Run;

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
    let fault = |column: &str, kind, looks_like: String, evidence: String, mend: String| Fault {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        columns: vec![column.to_string()],
        proven: kind != FaultKind::Held,
        kind,
        looks_like,
        evidence,
        mend,
    };
    let mut faults = Vec::new();
    if run.dt_s >= LONGEST_STEP_S {
        faults.push(fault(
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
                fault(
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
            faults.push(fault(
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

/// Channels of a run beyond all range; those with a fault already are passed over.
pub fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let judged = |name: &str| {
        known
            .iter()
            .any(|fault| fault.columns.iter().any(|c| c == name))
    };
    let fault = |name: &str| {
        let column = run.columns.get(name).filter(|_| !judged(name))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (kind, looks_like, found, expected, mend) = out_of_range(name, &values)?;
        Some(Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: vec![name.to_string()],
            kind,
            proven: true,
            looks_like: looks_like.to_string(),
            evidence: format!("{found}; expected {expected}"),
            mend: format!("{mend} for {name}"),
        })
    };
    COLUMNS.into_iter().filter_map(fault).collect()
}

type OutOfRange = (FaultKind, &'static str, String, &'static str, &'static str);

fn out_of_range(column: &str, values: &[f64]) -> Option<OutOfRange> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let found = format!("largest magnitude {largest:.4}");
    let unit =
        |looks_like, expected, mend| Some((FaultKind::Unit, looks_like, found, expected, mend));
    // A sled that spins slips by up to half a turn for a while, but not for most of its run.
    let spins = |values: &[f64]| {
        let far = values.iter().filter(|v| v.abs() > 0.4).count();
        largest <= std::f64::consts::PI && 4 * far < values.len()
    };
    match column {
        "alpha_rad" if largest > 0.4 && !spins(values) => unit(
            "degrees",
            "radians, magnitudes below 0.4 (23 degrees) but in a spin",
            "unit = \"deg\"",
        ),
        "gamma_rad" if largest > 0.4 => unit(
            "degrees",
            "radians, magnitudes below 0.4 (23 degrees)",
            "unit = \"deg\"",
        ),
        "delta_rad" if largest > 0.6 => unit(
            "degrees",
            "radians, magnitudes below 0.6 (34 degrees)",
            "unit = \"deg\"",
        ),
        "roll_rate_radps" | "pitch_rate_radps" | "yaw_rate_radps" if largest > 12.0 => unit(
            "degrees per second",
            "radians per second, magnitudes below 12",
            "unit = \"deg/s\"",
        ),
        "v_mps" if largest > 70.0 => unit("km/h", "metres per second, below 70", "unit = \"km/h\""),
        "ax_mps2" | "ay_mps2" | "az_mps2" if largest > 500.0 => unit(
            "a raw count or another unit",
            "metres per second squared, magnitudes below 500",
            "unit = \"...\"",
        ),
        "az_mps2" => {
            let mut sorted = values.to_vec();
            let middle = sorted.len() / 2;
            let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
            let found = format!("median {median:.3}");
            let expected = "metres per second squared, +9.81 at rest on level ice";
            if (0.5..4.5).contains(&median.abs()) {
                return Some((
                    FaultKind::Unit,
                    "multiples of g",
                    found,
                    expected,
                    "unit = \"g\"",
                ));
            }
            (median < 0.0).then_some((
                FaultKind::Sign,
                "an axis that points down",
                found,
                expected,
                "sign = -1",
            ))
        }
        _ => None,
    }
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
