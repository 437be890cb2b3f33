//! The measured columns beside those of the model, in one file.

use std::ops::Range;

use crate::record::run::Run;
use crate::replay::inputs::{Inputs, Reading};

/// A value of a reading.
type Of = fn(&Reading) -> f64;

/// Columns that stand beside the model's, and what they hold.
const BESIDE: [(&str, Of); 5] = [
    ("t_measured_s", |reading| reading.t_s),
    ("v_measured_mps", |reading| reading.values[0]),
    ("alpha_measured_rad", |reading| reading.values[1]),
    ("yaw_rate_measured_radps", |reading| reading.values[2]),
    ("gamma_measured_rad", |reading| reading.values[3]),
];

/// Puts what was measured at the same places beside a simulated run, as further columns; NaN in gaps and beyond the ends.
///
/// Between readings on a straight line; only what was recorded. The run must have `s_m`.
pub fn beside_measured(run: &mut Run, inputs: &Inputs) {
    let Some(places) = run.columns.get("s_m").cloned() else {
        return;
    };
    let recorded = std::iter::once(true).chain(inputs.recorded);
    for ((name, of), _) in BESIDE.iter().zip(recorded).filter(|(_, there)| *there) {
        let mut column = vec![f64::NAN; places.len()];
        for piece in &inputs.pieces {
            fill(&mut column, &places, &inputs.readings, piece, of);
        }
        run.columns.insert((*name).to_string(), column);
    }
}

fn fill(
    column: &mut [f64],
    places: &[f64],
    readings: &[Reading],
    piece: &Range<usize>,
    of: &dyn Fn(&Reading) -> f64,
) {
    let mut at = 0;
    for pair in readings[piece.clone()].windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        while at < places.len() && places[at] < a.s_m {
            at += 1;
        }
        while at < places.len() && places[at] <= b.s_m {
            let share = (places[at] - a.s_m) / (b.s_m - a.s_m).max(f64::MIN_POSITIVE);
            column[at] = of(a) + share * (of(b) - of(a));
            at += 1;
        }
    }
}
