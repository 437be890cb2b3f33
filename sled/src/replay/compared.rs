//! Run and model beside each other, place by place.

use std::ops::Range;

use serde::Serialize;

use crate::replay::inputs::{Inputs, READ};
use crate::simulate::drive::Simulated;
use crate::simulate::dynamics::Instant;
use crate::track::spline::Spline;

/// Run and model at one place.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Distance [m].
    pub s_m: f64,
    /// Time in the run and in the model [s].
    pub t_s: [f64; 2],
    /// Speed, slip angle, yaw rate and roll split in the run and in the model [m/s, rad, rad/s, rad].
    pub values: [[f64; 2]; 4],
}

impl Compared {
    /// Kinetic energy of the run less that of the model [J], from the speeds and the mass [kg].
    pub fn energy_gap(&self, mass_kg: f64) -> f64 {
        let [measured, model] = self.values[0];
        0.5 * mass_kg * (measured * measured - model * model)
    }
}

/// How far run and model are apart in one column, the run's less the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// The column.
    pub column: &'static str,
    /// Root mean square, in the column's unit.
    pub rms: f64,
    /// At the end.
    pub end: f64,
    /// The largest.
    pub largest: f64,
    /// Where that is [m].
    pub largest_at_m: f64,
}

/// What the sensors of the model would say, in the order of [`READ`].
pub(crate) fn said(instant: &Instant) -> [f64; 4] {
    let state = &instant.state;
    [
        state.v_mps,
        instant.alpha_sensor_rad,
        state.yaw_rate_radps,
        state.gamma_rad,
    ]
}

/// The readings that the model came past, each beside the model at the same place.
pub(crate) fn compare(
    inputs: &Inputs,
    simulated: &Simulated,
) -> (Vec<Compared>, Vec<Range<usize>>) {
    let mut onward: Vec<&Instant> = Vec::with_capacity(simulated.instants.len());
    for instant in &simulated.instants {
        if onward
            .last()
            .is_none_or(|last| instant.state.s_m > last.state.s_m)
        {
            onward.push(instant);
        }
    }
    let (mut compared, mut pieces) = (Vec::new(), Vec::new());
    if onward.len() < 2 {
        return (compared, pieces);
    }
    let places: Vec<f64> = onward.iter().map(|instant| instant.state.s_m).collect();
    let over = |value: &dyn Fn(&Instant) -> f64| {
        let values: Vec<f64> = onward.iter().map(|instant| value(instant)).collect();
        Spline::natural(&places, &values)
    };
    let time = over(&|instant| instant.state.t_s);
    let values: [Spline; 4] = std::array::from_fn(|k| over(&|instant| said(instant)[k]));
    let reach = places[0]..=places[places.len() - 1];
    for piece in &inputs.pieces {
        let start = compared.len();
        for reading in &inputs.readings[piece.clone()] {
            if !reach.contains(&reading.s_m) {
                continue;
            }
            compared.push(Compared {
                s_m: reading.s_m,
                t_s: [reading.t_s, time.value(reading.s_m)],
                values: std::array::from_fn(|k| [reading.values[k], values[k].value(reading.s_m)]),
            });
        }
        if start < compared.len() {
            pieces.push(start..compared.len());
        }
    }
    (compared, pieces)
}

/// Differences of time, speed and what else was recorded.
pub(crate) fn differences(compared: &[Compared], recorded: [bool; 4]) -> Vec<Difference> {
    let of = |column, gap: &dyn Fn(&Compared) -> f64| {
        let mean_square = compared.iter().map(|at| gap(at).powi(2)).sum::<f64>();
        let largest = compared
            .iter()
            .max_by(|a, b| gap(a).abs().total_cmp(&gap(b).abs()));
        Difference {
            column,
            rms: (mean_square / compared.len() as f64).sqrt(),
            end: compared.last().map_or(0.0, gap),
            largest: largest.map_or(0.0, gap),
            largest_at_m: largest.map_or(0.0, |at| at.s_m),
        }
    };
    let mut all = vec![of("t_s", &|at| at.t_s[0] - at.t_s[1])];
    for (k, sensor) in READ.iter().enumerate().filter(|(k, _)| recorded[*k]) {
        all.push(of(sensor.name(), &|at| at.values[k][0] - at.values[k][1]));
    }
    all
}
