//! Evaluation over speed and temperature of the ice besides force and curvature.
//!
//! A table of sliding contacts is a stack of layers, one for each speed and temperature, each a surface over force and curvature
//! ([`Lookup`]). Between layers the bilinear mode goes linearly; the smooth mode by cubic Hermite splines with three-point slopes
//! over the logarithm of the speed and the temperature: C1, exact for parabolas, and linear in the values of the layers, so that
//! the whole stays C1 in force and curvature too.

use crate::error::Error;
use crate::table::lookup::{Looked, Lookup, at_rocker, hermite};
use crate::table::mode::Mode;
use crate::table::nodes::Table;
use crate::table::place::{Axis, Place, fraction};
use crate::table::quantity::Quantity;

/// One quantity of a table over force, curvature, speed and temperature of the ice, ready for evaluation.
///
/// Also takes tables without one of the last two axes, or both: it then ignores that input.
///
/// ```
/// use kufe_lut::{Axes, Layered, Mode, Quantity, Sliding, Solved, Table};
/// let axes = Axes::new(vec![250.0, 2000.0], vec![0.0, 0.02], None)?
///     .sliding(Some(vec![5.0, 20.0, 35.0]), Some(vec![-10.0, -2.0]))?;
/// let nodes = axes.points().iter().map(|point| {
///     let mu = 1e-3 * point.speed.unwrap_or(1.0).sqrt();
///     let sliding = Sliding { mu, mu_error: 0.0, mu_ploughing: 0.1 * mu, mu_viscous: 0.9 * mu, groove_depth: 3e-5, film_mean: 5e-7 };
///     let rest = Solved { p_max: 1.5e7, p_max_error: 0.0, p_mean: 1e7, area: 1e-5, length: 0.05, width: 3e-4, approach: 1e-5, errors: None, sliding: None, method: Default::default() };
///     Solved { sliding: Some(sliding), ..rest }
/// }).collect();
/// let mu = Layered::new(&Table::new(axes, nodes, vec![])?, Quantity::Mu, Mode::Smooth, None)?;
/// let looked = mu.at(700.0, 0.013, 9.0, -4.0);
/// assert!((looked.value / 3e-3 - 1.0).abs() < 1e-12 && !looked.out_of_range);
/// assert!(mu.at(700.0, 0.013, 9.0, -11.0).out_of_range);
/// # Ok::<(), kufe_lut::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Layered {
    mode: Mode,
    speed: Option<Spline>,
    ice: Option<Spline>,
    /// One a speed and a temperature, temperatures fastest.
    layers: Vec<Lookup>,
    logarithmic: bool,
}

impl Layered {
    /// One quantity of a table; `rocker_radius` [m] where the table has that axis, as [`Lookup::with_rocker`].
    ///
    /// # Errors
    /// Those of [`Lookup::with_rocker`] for the rocker radius and the quantity.
    pub fn new(
        table: &Table,
        quantity: Quantity,
        mode: Mode,
        rocker_radius: Option<f64>,
    ) -> Result<Self, Error> {
        let axes = table.axes();
        let (values, logarithmic) = at_rocker(table, quantity, mode, rocker_radius)?;
        let [_, speeds, temperatures] = axes.inner();
        let count = speeds * temperatures;
        let layers = (0..count).map(|n| {
            let layer = values.iter().skip(n).step_by(count).copied().collect();
            Lookup::of_values(axes, layer, mode, logarithmic)
        });
        Ok(Layered {
            mode,
            speed: axes
                .speed()
                .map(|v| Spline::new(Axis::logarithmic(v), true)),
            ice: axes.ice_c().map(|t| Spline::new(Axis::plain(t), false)),
            layers: layers.collect(),
            logarithmic,
        })
    }

    /// Whether the table is over the temperature of the ice.
    pub fn asks_ice(&self) -> bool {
        self.ice.is_some()
    }

    /// The quantity at a force [N], a curvature [1/m], a speed [m/s] and a temperature of the ice [C].
    ///
    /// Inputs outside the table are clipped to it and flagged; NaN gives NaN and the flag.
    pub fn at(&self, fz: f64, curvature: f64, speed: f64, ice_c: f64) -> Looked {
        let unknown = |axis: &Option<Spline>, value: f64| axis.is_some() && value.is_nan();
        if fz.is_nan()
            || curvature.is_nan()
            || unknown(&self.speed, speed)
            || unknown(&self.ice, ice_c)
        {
            return Looked {
                value: f64::NAN,
                out_of_range: true,
            };
        }
        let (x, y) = self.layers[0].places(fz, curvature);
        let (speeds, beyond) = Weights::at(self.speed.as_ref(), speed, self.mode);
        let (temperatures, outside) = Weights::at(self.ice.as_ref(), ice_c, self.mode);
        let value = match self.mode {
            Mode::Bilinear => {
                speeds.sum(|l| temperatures.sum(|m| self.layer(l, m).bilinear(&x, &y)))
            }
            Mode::Smooth => {
                // Differences to one node, so that nodes come out as they went in.
                let near = self.layer(speeds.nearest, temperatures.nearest);
                let corner = near.corner(&x, &y);
                let (plain, jets, _) = near.parts();
                let (start, base) = (plain[corner], jets[corner].f);
                let rise = speeds.sum(|l| {
                    temperatures.sum(|m| {
                        let layer = self.layer(l, m);
                        (layer.parts().1[corner].f - base) + layer.rise(&x, &y)
                    })
                });
                if self.logarithmic {
                    start * rise.exp()
                } else {
                    start + rise
                }
            }
        };
        Looked {
            value,
            out_of_range: x.outside || y.outside || beyond || outside,
        }
    }

    fn layer(&self, speed: usize, ice: usize) -> &Lookup {
        let temperatures = self.ice.as_ref().map_or(1, |ice| ice.axis.plain.len());
        &self.layers[speed * temperatures + ice]
    }

    /// Mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// What the C code needs: the layers, and whether they are of logarithms.
    pub(crate) fn parts(&self) -> (&[Lookup], bool) {
        (&self.layers, self.logarithmic)
    }

    /// The splines along speed and temperature.
    pub(crate) fn splines(&self) -> [Option<&Spline>; 2] {
        [self.speed.as_ref(), self.ice.as_ref()]
    }
}

/// Breakpoints along which layers lie.
#[derive(Clone, Debug)]
pub(crate) struct Spline {
    pub axis: Axis,
    /// Whether the smooth mode sees logarithms.
    pub logarithmic: bool,
    /// Of every cell: weights of its window's layers in the slopes at both ends.
    pub slopes: Vec<[[f64; WINDOW]; 2]>,
}

/// Layers that a cell's cubic depends on, at most.
pub(crate) const WINDOW: usize = 4;

impl Spline {
    fn new(axis: Axis, logarithmic: bool) -> Self {
        let x = &axis.scaled;
        let slopes = (0..x.len().saturating_sub(1)).map(|low| {
            let start = window(low, x.len()).start;
            [low, low + 1].map(|node| slope(x, node, start))
        });
        Spline {
            slopes: slopes.collect(),
            axis,
            logarithmic,
        }
    }
}

/// The layers around a cell.
fn window(low: usize, n: usize) -> std::ops::Range<usize> {
    let start = low.saturating_sub(1).min(n.saturating_sub(WINDOW));
    start..n.min(start + WINDOW)
}

/// Weights of the layers from `start` in the three-point slope at a node: exact for parabolas, one-sided at the ends.
fn slope(x: &[f64], node: usize, start: usize) -> [f64; WINDOW] {
    let mut weights = [0.0; WINDOW];
    let n = x.len();
    if n == 2 {
        let h = x[1] - x[0];
        weights[..2].copy_from_slice(&[-1.0 / h, 1.0 / h]);
        return weights;
    }
    let centre = node.clamp(1, n - 2);
    let (a, b) = (x[centre] - x[centre - 1], x[centre + 1] - x[centre]);
    // Derivative at x[node] of the parabola through the three, in Lagrange's form.
    let t = x[node] - x[centre];
    weights[centre - 1 - start] = (2.0 * t - b) / (a * (a + b));
    weights[centre - start] = (b - a - 2.0 * t) / (a * b);
    weights[centre + 1 - start] = (2.0 * t + a) / (b * (a + b));
    weights
}

/// What the layers along one axis count at a place.
struct Weights {
    first: usize,
    count: usize,
    of: [f64; WINDOW],
    nearest: usize,
}

impl Weights {
    /// At a value, no NaN, and whether that lies outside; one layer where there is no axis.
    fn at(spline: Option<&Spline>, value: f64, mode: Mode) -> (Self, bool) {
        let one = |first| Weights {
            first,
            count: 1,
            of: [1.0, 0.0, 0.0, 0.0],
            nearest: first,
        };
        let Some(spline) = spline else {
            return (one(0), false);
        };
        let place = spline.axis.place(value);
        if place.low == place.high {
            return (one(place.low), place.outside);
        }
        let weights = match mode {
            Mode::Bilinear => {
                let t = fraction(&spline.axis.plain, &place, place.clipped);
                Weights {
                    first: place.low,
                    count: 2,
                    of: [1.0 - t, t, 0.0, 0.0],
                    nearest: place.low,
                }
            }
            Mode::Smooth => Self::cubic(spline, &place),
        };
        (weights, place.outside)
    }

    fn cubic(spline: &Spline, place: &Place) -> Self {
        let scaled = &spline.axis.scaled;
        let input = if spline.logarithmic {
            place.clipped.ln()
        } else {
            place.clipped
        };
        let t = fraction(scaled, place, input);
        let [x0, x1, x2] = hermite(t, scaled[place.high] - scaled[place.low]);
        let window = window(place.low, scaled.len());
        let [at_low, at_high] = &spline.slopes[place.low];
        let mut of: [f64; WINDOW] = std::array::from_fn(|n| at_low[n] * x1 + at_high[n] * x2);
        of[place.low - window.start] += 1.0 - x0;
        of[place.high - window.start] += x0;
        Weights {
            first: window.start,
            count: window.len(),
            of,
            nearest: place.low,
        }
    }

    fn sum(&self, value: impl Fn(usize) -> f64) -> f64 {
        let terms = self.of[..self.count].iter().enumerate();
        // A layer of no weight need not be looked at.
        let counted = terms.filter(|(_, weight)| **weight != 0.0);
        counted
            .map(|(n, weight)| weight * value(self.first + n))
            .sum()
    }
}
