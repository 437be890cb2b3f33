//! What layers change of a half-space's displacement, over the distance from a point force.

use std::f64::consts::PI;

use super::layers::{Layer, compliance};

/// Largest wave number times the upper layer's thickness that is kept: beyond, layers and half-space differ by e^-20.
const LARGEST: f64 = 10.0;
/// Distance over the layers' whole thickness from which nothing moves: displacements over a rigid bed fall exponentially.
const FARTHEST: f64 = 15.0;
/// Places of the table over the upper layer's thickness.
const PLACES: f64 = 8.0;
/// Most that k r may grow over one panel of the quadrature.
const PANEL: f64 = 4.0;

/// Abscissae and weights of Gauss-Legendre quadrature on [-1, 1] (M. Abramowitz and I. A. Stegun, Handbook, 1964, table 25.4).
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_29],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

/// D(r): displacement at distance r of a unit force on layers less that on a half-space of the upper layer's material [m/N].
///
/// D(r) = 1/(2 pi) int (k C(k) - c) J0(k r) dk with the layers' compliance C and c = k times the half-space's.
pub(super) struct Radial {
    /// Values at even steps from r = 0.
    values: Vec<f64>,
    step: f64,
    /// 1 / (pi E*) of the half-space [1/Pa].
    force: f64,
    /// From here on the layers do not move [m].
    pub end: f64,
}

impl Radial {
    /// A table up to `reach` [m].
    pub fn new(layers: &[Layer], reach: f64) -> Self {
        let own = layers[0].half_space();
        let upper = layers[0].thickness;
        let end = FARTHEST * layers.iter().map(|layer| layer.thickness).sum::<f64>();
        let reach = reach.min(end);
        let last = LARGEST / upper;
        let panels = (LARGEST.max(last * reach) / PANEL).ceil();
        let half = 0.5 * last / panels;
        let waves: Vec<[f64; 2]> = (0..panels as usize)
            .flat_map(|panel| {
                let middle = (2.0 * panel as f64 + 1.0) * half;
                GAUSS
                    .iter()
                    .flat_map(move |&[x, w]| [[middle - half * x, w], [middle + half * x, w]])
            })
            .map(|[k, w]| [k, w * half * (k * compliance(layers, k) - own) / (2.0 * PI)])
            .collect();
        let step = upper / PLACES;
        let places = (reach / step).ceil() as usize + 3;
        let values = (0..places)
            .map(|i| {
                let r = i as f64 * step;
                waves.iter().map(|[k, w]| w * libm::j0(k * r)).sum()
            })
            .collect();
        Radial {
            values,
            step,
            force: own / (2.0 * PI),
            end,
        }
    }

    /// D at a distance [m/N], by the cubic through the four nearest places.
    pub fn at(&self, r: f64) -> f64 {
        if r >= self.end {
            return -self.force / r;
        }
        let place = r / self.step;
        let cell = (place as usize).min(self.values.len() - 3);
        let t = place - cell as f64;
        let before = match cell {
            0 => self.values[1],
            _ => self.values[cell - 1],
        };
        let [a, b, c] = [0, 1, 2].map(|k| self.values[cell + k]);
        let outer = (t + 1.0) * (t - 2.0);
        let inner = t * (t - 1.0);
        -before * inner * (t - 2.0) / 6.0 + a * outer * (t - 1.0) / 2.0 - b * outer * t / 2.0
            + c * inner * (t + 1.0) / 6.0
    }
}
