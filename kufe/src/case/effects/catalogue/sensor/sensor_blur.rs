//! The map is convolved with a Gaussian of deviation w in both directions; another modulus keeps the edges sharp.

use crate::case::effects::effect::prelude::*;

pub static EFFECT: Effect = Effect {
    info: Info {
        name: "sensor-blur",
        summary: "the sensor washes the map out",
        formula: "Gaussian of deviation w",
        signature: "the peak lower, the edges washed out, the sum kept",
        acts_on: &[ActsOn::Map],
        parameters: &[Parameter::amplitude("width_m", "m", 0.0, 0.02, 0.0005)],
        looks_like: &["ice-modulus", "hardness"],
        decides: "a map of a sharp edge",
        source: "point-spread function of pressure-sensitive film",
        ..Effect::ON_PRESSURE
    },
    on_map: Some(|value, map| {
        if value == 0.0 {
            return;
        }
        // Separable: along the rows, then along the columns; what leaves the map is lost as on a film.
        let pass = |values: &[f64], n: usize, step: f64| -> Vec<f64> {
            let reach = ((4.0 * value / step).ceil() as usize).min(n);
            let weight = |k: usize| (-0.5 * (k as f64 * step / value).powi(2)).exp();
            let sum = 1.0 + 2.0 * (1..=reach).map(weight).sum::<f64>();
            (0..n)
                .map(|i| {
                    (i.saturating_sub(reach)..(i + reach + 1).min(n))
                        .map(|j| weight(i.abs_diff(j)) * values[j])
                        .sum::<f64>()
                        / sum
                })
                .collect()
        };
        for row in map.pressure.chunks_mut(map.nx) {
            let blurred = pass(row, row.len(), map.dx);
            row.copy_from_slice(&blurred);
        }
        for i in 0..map.nx {
            let column: Vec<f64> = (0..map.ny).map(|j| map.pressure[j * map.nx + i]).collect();
            for (j, p) in pass(&column, map.ny, map.dy).into_iter().enumerate() {
                map.pressure[j * map.nx + i] = p;
            }
        }
    }),
    search: Search {
        needs_map: true,
        growth: Growth::Square,
        adds: Adds::Squares,
        ..Search::NEW
    },
    example: Example {
        size: 2.0e-3,
        of: "largest pixel [Pa]",
        measure: Measure::OfMap(|map| map.pressure.iter().copied().fold(0.0, f64::max)),
        gives: 39_790.135_140_764_02,
    },
    ..Effect::NEW
};
