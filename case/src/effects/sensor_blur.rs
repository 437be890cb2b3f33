//! The map convolved with a Gaussian of deviation w [m] in both directions. Signature: the peak lower, the edges washed out, the sum kept.
//! Confounders: modulus (which keeps the edges sharp). Source: point-spread function of pressure-sensitive film.

use super::{Effect, Info, Map};

/// See the module.
pub struct SensorBlur;

static INFO: Info = Info {
    name: "sensor-blur",
    key: "width_m",
    unit: "m",
    low: 0.0,
    high: 0.02,
    typical: 0.0005,
    decides: "a map of a sharp edge",
};

impl Effect for SensorBlur {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn is_of_the_sensor(&self) -> bool {
        true
    }

    fn sense(&self, value: f64, map: &mut Map) {
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
    }
}
