//! Evaluation of a table between its nodes.
//!
//! The first two axes, force and curvature, span a surface. Further axes stack such surfaces as
//! layers.
//!
//! - The bilinear mode is linear along every axis.
//! - The smooth mode interpolates each surface by bicubic Hermite patches over the logarithm of the
//!   force and the curvature ([`crate::monotone`]), and between layers uses cubic Hermite splines
//!   with three-point slopes, over the logarithm of the speed and the temperature. These are exact
//!   for parabolas and linear in the values of the layers, so that the interpolant is C1 in force
//!   and curvature too.

use serde::{Deserialize, Serialize};

use crate::axes::{Axes, AxisKind, Outside, Point};
use crate::error::Error;
use crate::monotone::{Jet, jets};
use crate::quantity::Quantity;
use crate::reduced::CurvatureScaling;
use crate::table::Table;

/// Interpolation mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Piecewise linear on the table's own axes and values, as Simulink's n-D Lookup Table computes
    /// it with "linear point-slope", "clip" and "use last table value" (MathWorks guideline
    /// jc_0626).
    Bilinear,
    /// C1, and monotone where the data are: bicubic Hermite patches of the logarithm of the
    /// quantity over the logarithm of the force and the (reduced) curvature.
    Smooth,
}

impl Mode {
    /// Both modes.
    pub const ALL: [Mode; 2] = [Mode::Bilinear, Mode::Smooth];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        ["bilinear", "smooth"][self as usize]
    }
}

/// An interpolated value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolated {
    /// The value, in the quantity's unit; NaN if an input was NaN, or outside an axis with the rule
    /// [`Outside::Error`].
    pub value: f64,
    /// Whether an input was outside the table or NaN.
    pub out_of_range: bool,
}

impl Interpolated {
    /// No value.
    const NONE: Interpolated = Interpolated {
        value: f64::NAN,
        out_of_range: true,
    };
}

/// One quantity of a table, ready for evaluation.
///
/// A contact between a smooth hull and ice follows power laws in the load (pressure as `Fz^(1/3)`,
/// area as `Fz^(2/3)`), which are straight lines on logarithmic axes. The smooth mode interpolates
/// logarithms, so that few nodes suffice. A quantity with a value that is not positive is
/// interpolated without the logarithm.
///
/// ```
/// use kufe_lut::{Axes, Figures, Interpolator, Mode, Point, Quantity, Table};
/// let axes = Axes::new(vec![250.0, 2000.0], vec![0.0, 0.02])?;
/// let nodes: Vec<Figures> = axes.points().iter().map(|point| {
///     let p_max = 1e8 * (point.fz / 1000.0).cbrt() * (1.0 - 10.0 * point.curvature);
///     Figures::at_rest([p_max, p_max / 1.5, 1e-5, 0.05, 3e-4, 1e-5]).with_error(Quantity::PMax, 0.0)
/// }).collect();
/// let table = Table::new(axes, &nodes, vec![])?;
/// let p_max = Interpolator::new(&table, Quantity::PMax, Mode::Smooth, None)?;
/// let inside = p_max.at(Point::at_rest(1000.0, 0.0));
/// assert!((inside.value / 1e8 - 1.0).abs() < 1e-12 && !inside.out_of_range);
/// assert!(p_max.at(Point::at_rest(9000.0, 0.0)).out_of_range);
/// # Ok::<(), kufe_lut::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Interpolator {
    mode: Mode,
    fz: Breakpoints,
    curvature: Breakpoints,
    /// Parameters of the reduced curvatures, if the second axis has them.
    flush: Option<CurvatureScaling>,
    /// The further axes, which stack the layers, the last one fastest.
    stack: Vec<Breakpoints>,
    /// Values without the logarithm: layer by layer, rows of constant force.
    pub(crate) values: Vec<f64>,
    /// Smooth mode only: jets of the scaled values over the scaled axes.
    jets: Vec<Jet>,
    /// Whether the jets are of logarithms.
    pub(crate) logarithmic: bool,
}

/// Largest number of axes that stack layers.
const MAX_STACK: usize = 2;

impl Interpolator {
    /// One quantity of a table, at one rocker radius [m] if the table has that axis.
    ///
    /// A runner's rocker radius is constant, so that it is interpolated only here: linearly
    /// (bilinear mode, equal to Simulink's lookup with one more dimension) or linearly in the
    /// logarithms of radius and quantity (smooth mode). Both keep the data monotone along the other
    /// axes.
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] if the table has a rocker axis and no radius is given,
    /// [`Error::Invalid`] if the radius is outside the axis or there is no such axis,
    /// [`Error::NoQuantity`] for a quantity of sliding contacts in a table at rest.
    pub fn new(
        table: &Table,
        quantity: Quantity,
        mode: Mode,
        rocker_radius: Option<f64>,
    ) -> Result<Self, Error> {
        let axes = table.axes();
        let all = table.values(quantity).ok_or(Error::NoQuantity {
            quantity: quantity.name(),
        })?;
        let logarithmic = mode == Mode::Smooth && all.iter().all(|&value| value > 0.0);
        let nodes = at_rocker(table, all, mode, logarithmic, rocker_radius)?;
        let breakpoints = |kind| Breakpoints::new(axes, kind);
        let [fz, curvature] = [AxisKind::Fz, AxisKind::Curvature].map(breakpoints);
        let stack = axes.present().map(|(kind, _)| kind);
        let stack = stack.filter(|kind| kind.is_sliding()).map(breakpoints);
        let stack: Vec<Breakpoints> = stack.collect();
        assert!(stack.len() <= MAX_STACK, "{} axes of layers", stack.len());
        let layers: usize = stack.iter().map(|axis| axis.plain.len()).product();
        let by_layer = (0..layers).flat_map(|n| nodes.iter().skip(n).step_by(layers).copied());
        let values: Vec<f64> = by_layer.collect();
        let mut all_jets = Vec::new();
        if mode == Mode::Smooth {
            let scale = |&value: &f64| if logarithmic { value.ln() } else { value };
            for layer in values.chunks_exact(values.len() / layers) {
                let scaled: Vec<f64> = layer.iter().map(scale).collect();
                all_jets.extend(jets(&fz.scaled, &curvature.scaled, &scaled));
            }
        }
        Ok(Interpolator {
            mode,
            fz,
            curvature,
            flush: axes.flush().copied(),
            stack,
            values,
            jets: all_jets,
            logarithmic,
        })
    }

    /// The quantity at a point. Coordinates along axes that the table does not have are ignored.
    /// The rocker radius is also ignored; it is the one of [`new`](Self::new).
    ///
    /// Inputs outside the table set the flag and are treated by the rules of their axes
    /// ([`Outside`]). NaN or a missing coordinate gives NaN and sets the flag. An evaluation does
    /// not allocate and needs at most `log2` of the axes' lengths in comparisons.
    #[inline]
    pub fn at(&self, point: Point) -> Interpolated {
        let missing = |axis: &Breakpoints| point.get(axis.kind).is_none_or(f64::is_nan);
        if point.fz.is_nan() || point.curvature.is_nan() || self.stack.iter().any(missing) {
            return Interpolated::NONE;
        }
        // A lifted runner has the pressure of a force of 0.
        let x = self.fz.place(point.fz.max(0.0));
        let y = self.curvature.place(match &self.flush {
            None => point.curvature,
            Some(flush) => flush.reduced(self.fz.clamped(point.fz), point.curvature),
        });
        if self.stack.is_empty() {
            let outside = x.outside || y.outside;
            if outside && self.is_refused(&[x, y]) {
                return Interpolated::NONE;
            }
            let value = match self.mode {
                Mode::Bilinear => self.bilinear(0, &x, &y),
                Mode::Smooth => {
                    self.add_scaled(self.corner(0, &x, &y), self.patch_difference(0, &x, &y))
                }
            };
            return Interpolated {
                value,
                out_of_range: outside,
            };
        }
        let mut places = [x, y, Place::default(), Place::default()];
        for (place, axis) in places[2..].iter_mut().zip(&self.stack) {
            *place = axis.place(point.get(axis.kind).unwrap_or(f64::NAN));
        }
        let outside = places.iter().any(|place| place.outside);
        if outside && self.is_refused(&places) {
            return Interpolated::NONE;
        }
        Interpolated {
            value: self.between_layers(&places[2..], &x, &y),
            out_of_range: outside,
        }
    }

    /// Whether an input is outside an axis whose rule is an error.
    #[cold]
    fn is_refused(&self, places: &[Place]) -> bool {
        let mut pairs = self.axes().zip(places);
        pairs.any(|(axis, place)| place.outside && axis.outside == Outside::Error)
    }

    /// The value between layers.
    fn between_layers(&self, places: &[Place], x: &Place, y: &Place) -> f64 {
        let mut weights = [Weights::default(); MAX_STACK];
        let mut nearest = 0;
        for ((weights, axis), place) in weights.iter_mut().zip(&self.stack).zip(places) {
            *weights = axis.weights(place, self.mode);
            nearest = nearest * weights.layers + place.low;
        }
        let weights = &weights[..self.stack.len()];
        match self.mode {
            Mode::Bilinear => weighted_sum(weights, 0, &|layer| self.bilinear(layer, x, y)),
            Mode::Smooth => {
                // Sums differences from one node, so that nodes are reproduced exactly.
                let near = self.corner(nearest, x, y);
                let base = self.jets[near].f;
                let difference = weighted_sum(weights, 0, &|layer| {
                    (self.jets[self.corner(layer, x, y)].f - base)
                        + self.patch_difference(layer, x, y)
                });
                self.add_scaled(near, difference)
            }
        }
    }

    /// The value at a node plus a difference of scaled values.
    #[inline]
    fn add_scaled(&self, node: usize, difference: f64) -> f64 {
        let start = self.values[node];
        if self.logarithmic {
            start * difference.exp()
        } else {
            start + difference
        }
    }

    /// The node at the lower corner of a cell of a layer.
    #[inline]
    fn corner(&self, layer: usize, x: &Place, y: &Place) -> usize {
        let columns = self.curvature.plain.len();
        (layer * self.fz.plain.len() + x.low) * columns + y.low
    }

    /// Bilinear interpolation between the corners of a cell.
    #[inline]
    fn bilinear(&self, layer: usize, x: &Place, y: &Place) -> f64 {
        let columns = self.curvature.plain.len();
        let values = &self.values[layer * self.fz.plain.len() * columns..];
        let tx = fraction(&self.fz.plain, x, x.at);
        let ty = fraction(&self.curvature.plain, y, y.at);
        let along = |column: usize| {
            let [a, b] = [x.low, x.high].map(|row| values[row * columns + column]);
            a + (b - a) * tx
        };
        let (left, right) = (along(y.low), along(y.high));
        left + (right - left) * ty
    }

    /// Hermite patch minus its value at the lower corner, so that nodes are reproduced exactly.
    #[inline]
    fn patch_difference(&self, layer: usize, x: &Place, y: &Place) -> f64 {
        let columns = self.curvature.plain.len();
        let jets = &self.jets[layer * self.fz.plain.len() * columns..];
        let corner = |i: usize, j: usize| &jets[i * columns + j];
        let (a, b) = (corner(x.low, y.low), corner(x.high, y.low));
        let (c, d) = (corner(x.low, y.high), corner(x.high, y.high));
        let [x0, x1, x2] = self.fz.hermite(x);
        let [y0, y1, y2] = self.curvature.hermite(y);
        // Along x on both grid lines: the value minus f of corner `a`, and the slope along y.
        let [[ax, ay], [bx, by], [cx, cy], [dx, dy]] = [a, b, c, d].map(|jet| jet.slopes);
        let low = (b.f - a.f) * x0 + ax * x1 + bx * x2;
        let high = (c.f - a.f) + ((d.f - c.f) * x0 + cx * x1 + dx * x2);
        let low_slope = ay + ((by - ay) * x0 + a.twist * x1 + b.twist * x2);
        let high_slope = cy + ((dy - cy) * x0 + c.twist * x1 + d.twist * x2);
        low + ((high - low) * y0 + low_slope * y1 + high_slope * y2)
    }

    /// Whether the quantity depends on the coordinate along an axis.
    pub fn has(&self, kind: AxisKind) -> bool {
        self.axis(kind).is_some()
    }

    fn axes(&self) -> impl Iterator<Item = &Breakpoints> {
        [&self.fz, &self.curvature].into_iter().chain(&self.stack)
    }

    /// The axis of a kind; `None` if the quantity does not depend on it.
    pub(crate) fn axis(&self, kind: AxisKind) -> Option<&Breakpoints> {
        self.axes().find(|axis| axis.kind == kind)
    }

    /// Jets of all layers, four numbers per node.
    pub(crate) fn flat_jets(&self) -> Vec<f64> {
        let jets = self.jets.iter();
        jets.flat_map(|jet| [jet.f, jet.slopes[0], jet.slopes[1], jet.twist])
            .collect()
    }
}

/// Selects or interpolates the values at one rocker radius from the values at all nodes.
fn at_rocker(
    table: &Table,
    all: Vec<f64>,
    mode: Mode,
    logarithmic: bool,
    rocker_radius: Option<f64>,
) -> Result<Vec<f64>, Error> {
    let (radii, radius) = match (table.axes().rocker_radius(), rocker_radius) {
        (None, None) => return Ok(all),
        (Some(radii), None) => {
            return Err(Error::RockerNeeded {
                low: radii[0],
                high: radii[radii.len() - 1],
            });
        }
        (None, Some(value)) => {
            let span = "one runner, without a rocker axis";
            return Err(Error::rocker_outside(value, span));
        }
        (Some(radii), Some(radius)) => (radii, radius),
    };
    let last = radii.len() - 1;
    if !(radii[0]..=radii[last]).contains(&radius) {
        let span = format!("{} to {} m", radii[0], radii[last]);
        return Err(Error::rocker_outside(radius, &span));
    }
    let low = radii.partition_point(|&r| r <= radius) - 1;
    let high = (low + 1).min(last);
    let t = match (low == high, mode) {
        (true, _) => 0.0,
        (_, Mode::Bilinear) => (radius - radii[low]) / (radii[high] - radii[low]),
        (_, Mode::Smooth) => (radius / radii[low]).ln() / (radii[high] / radii[low]).ln(),
    };
    let between = |a: f64, b: f64| {
        if logarithmic {
            a * ((b / a).ln() * t).exp()
        } else {
            a + (b - a) * t
        }
    };
    // Rocker radii are the slowest of the nodes at one force and curvature.
    let inner = table.axes().layers() / radii.len();
    let lines = all.chunks_exact(radii.len() * inner);
    let at_radius = lines.flat_map(|line| {
        (0..inner).map(move |n| between(line[low * inner + n], line[high * inner + n]))
    });
    Ok(at_radius.collect())
}

/// The breakpoints of an axis.
#[derive(Clone, Debug)]
pub(crate) struct Breakpoints {
    pub kind: AxisKind,
    pub outside: Outside,
    /// The breakpoints.
    pub plain: Vec<f64>,
    /// Coordinates of the smooth mode: the logarithms of the breakpoints, or the breakpoints.
    pub scaled: Vec<f64>,
    /// For an axis of layers, per cell: weights of the layers of its window in the slopes at both
    /// ends.
    pub slopes: Vec<[[f64; WINDOW]; 2]>,
}

/// Cell of an input on an axis: the breakpoint at or below it and the next one.
#[derive(Clone, Copy, Default)]
struct Place {
    low: usize,
    high: usize,
    /// The input, or the end of the axis that replaces it.
    at: f64,
    outside: bool,
}

impl Breakpoints {
    fn new(axes: &Axes, kind: AxisKind) -> Self {
        let values = axes.get(kind).unwrap_or_default();
        let scaled: Vec<f64> = values.iter().map(|&value| kind.scaled(value)).collect();
        let slopes = |low: usize| {
            let start = window(low, scaled.len()).start;
            [low, low + 1].map(|node| slope(&scaled, node, start))
        };
        let cells = 0..values.len().saturating_sub(1);
        Breakpoints {
            kind,
            outside: axes.outside(kind),
            plain: values.to_vec(),
            slopes: cells.filter(|_| kind.is_sliding()).map(slopes).collect(),
            scaled,
        }
    }

    /// The input, limited to the range of the axis.
    #[inline]
    fn clamped(&self, value: f64) -> f64 {
        value.clamp(self.plain[0], self.plain[self.plain.len() - 1])
    }

    #[inline]
    fn place(&self, value: f64) -> Place {
        let last = self.plain.len() - 1;
        if value >= self.plain[last] {
            let outside = value > self.plain[last];
            let continued = outside && self.outside == Outside::Linear;
            return Place {
                low: last.saturating_sub(usize::from(continued)),
                high: last,
                at: if continued { value } else { self.plain[last] },
                outside,
            };
        }
        if value <= self.plain[0] {
            let outside = value < self.plain[0];
            let continued = outside && self.outside == Outside::Linear;
            return Place {
                low: 0,
                high: 1.min(last),
                at: if continued { value } else { self.plain[0] },
                outside,
            };
        }
        // Bisection without branches, since random inputs would mispredict every second one.
        let (mut low, mut rest) = (0, last);
        while rest > 1 {
            let half = rest / 2;
            let above = value >= self.plain[low + half];
            low = std::hint::select_unpredictable(above, low + half, low);
            rest -= half;
        }
        Place {
            low,
            high: low + 1,
            at: value,
            outside: false,
        }
    }

    /// Hermite weights of the upper value and of both slopes at a place.
    #[inline]
    fn hermite(&self, place: &Place) -> [f64; 3] {
        if place.outside {
            return self.extrapolated(place);
        }
        let [low, high] = [place.low, place.high].map(|k| self.scaled[k]);
        let (h, at) = (high - low, self.kind.scaled(place.at));
        // An axis of one breakpoint has a length of 0.
        let t = if h > 0.0 { (at - low) / h } else { 0.0 };
        hermite(t, h)
    }

    /// As [`Self::hermite`] outside the axis: linear extrapolation, below a logarithmic axis along
    /// the tangent.
    #[cold]
    fn extrapolated(&self, place: &Place) -> [f64; 3] {
        let (first, at) = (self.plain[0], place.at);
        let scaled = if at < first && self.kind.is_logarithmic() {
            self.scaled[0] + (at - first) / first
        } else {
            self.kind.scaled(at)
        };
        let t = fraction(&self.scaled, place, scaled);
        let h = self.scaled[place.high] - self.scaled[place.low];
        if t >= 0.5 {
            [1.0, 0.0, h * (t - 1.0)]
        } else {
            [0.0, h * t, 0.0]
        }
    }
}

/// Position between two breakpoints from 0 to 1; 0 if they are the same.
#[inline]
fn fraction(axis: &[f64], place: &Place, value: f64) -> f64 {
    if place.low == place.high {
        return 0.0;
    }
    (value - axis[place.low]) / (axis[place.high] - axis[place.low])
}

/// Hermite weights of the upper value and of both slopes.
#[inline]
fn hermite(t: f64, h: f64) -> [f64; 3] {
    let s = 1.0 - t;
    [t * t * (3.0 - 2.0 * t), h * t * s * s, -(h * t * t * s)]
}

/// Largest number of layers that the cubic of a cell depends on.
pub(crate) const WINDOW: usize = 4;

impl Breakpoints {
    /// Weights of the layers at a place.
    fn weights(&self, place: &Place, mode: Mode) -> Weights {
        let layers = self.plain.len();
        let mut weights = Weights {
            layers,
            first: place.low,
            values: [1.0, 0.0, 0.0, 0.0],
        };
        if place.low == place.high {
            return weights;
        }
        if mode == Mode::Bilinear {
            let t = fraction(&self.plain, place, place.at);
            weights.values = [1.0 - t, t, 0.0, 0.0];
            return weights;
        }
        let [x0, x1, x2] = self.hermite(place);
        let window = window(place.low, layers);
        let [at_low, at_high] = &self.slopes[place.low];
        weights.first = window.start;
        weights.values = std::array::from_fn(|n| at_low[n] * x1 + at_high[n] * x2);
        weights.values[place.low - window.start] += 1.0 - x0;
        weights.values[place.high - window.start] += x0;
        weights
    }
}

/// The layers around a cell.
fn window(low: usize, n: usize) -> std::ops::Range<usize> {
    let start = low.saturating_sub(1).min(n.saturating_sub(WINDOW));
    start..n.min(start + WINDOW)
}

/// Weights of the layers from `start` in the three-point slope at a node: exact for parabolas,
/// one-sided at the ends.
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

/// Weights of the layers along one axis.
#[derive(Clone, Copy, Default)]
struct Weights {
    /// Number of layers along the axis.
    layers: usize,
    first: usize,
    /// Weights from layer `first` on; 0 after the last layer.
    values: [f64; WINDOW],
}

/// Weighted sum of `value` over all combinations of layers, `from` being the index of the layer of
/// the previous axes.
fn weighted_sum(weights: &[Weights], from: usize, value: &impl Fn(usize) -> f64) -> f64 {
    let Some((axis, inner)) = weights.split_first() else {
        return value(from);
    };
    // For an infinite input the weights after the last layer are NaN.
    let layers = axis.layers - axis.first;
    let terms = axis.values.iter().take(layers).enumerate();
    // A layer of weight 0 need not be evaluated.
    let counted = terms.filter(|(_, weight)| **weight != 0.0);
    let from = from * axis.layers + axis.first;
    counted
        .map(|(n, weight)| weight * weighted_sum(inner, from + n, value))
        .sum()
}
