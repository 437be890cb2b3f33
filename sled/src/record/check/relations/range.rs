//! What no sled reaches in a column's unit but easily does in the usual wrong one.

use crate::record::check::relations::fault::{Fault, FaultKind};
use crate::record::run::{COLUMNS, Run};

/// Channels of a run beyond all range; those with a fault already are passed over.
pub fn range_faults(run: &Run, known: &[Fault]) -> Vec<Fault> {
    let judged = |name: &str| {
        known
            .iter()
            .any(|fault| fault.columns.iter().any(|c| c == name))
    };
    let told = |name: &str| {
        let column = run.columns.get(name).filter(|_| !judged(name))?;
        let values: Vec<f64> = run.gaps.within(column).flatten().copied().collect();
        let (kind, looks_like, found, expected, mend) = out_of_range(name, &values)?;
        Some(Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: vec![name.to_string()],
            kind,
            looks_like: looks_like.to_string(),
            evidence: format!("{found}; expected {expected}"),
            mend: format!("{mend} for {name}"),
        })
    };
    COLUMNS.into_iter().filter_map(told).collect()
}

type OutOfRange = (FaultKind, &'static str, String, &'static str, &'static str);

fn out_of_range(column: &str, values: &[f64]) -> Option<OutOfRange> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let found = format!("largest magnitude {largest:.4}");
    let unit =
        |looks_like, expected, mend| Some((FaultKind::Unit, looks_like, found, expected, mend));
    match column {
        "alpha_rad" | "gamma_rad" if largest > 0.4 => unit(
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
