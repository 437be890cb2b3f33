//! Evaluation of a table.

use crate::error::Error;
use crate::table::axes::{Axes, MAX_AXIS};
use crate::table::flush::Flush;
use crate::table::mode::Mode;
use crate::table::nodes::Table;
use crate::table::place::{Axis, Place, fraction};
use crate::table::quantity::Quantity;
use crate::table::smooth::{Jet, jets};

/// A looked-up value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Looked {
    /// The value, in the quantity's unit; NaN where an input was NaN.
    pub value: f64,
    /// Whether an input was outside the table (and was clipped to it) or NaN.
    pub out_of_range: bool,
}

/// One quantity of a table over force and curvature, ready for evaluation.
///
/// A contact between a smooth hull and ice follows power laws in the load (pressure as `Fz^(1/3)`, area as
/// `Fz^(2/3)`), which are straight lines in logarithms: there the smooth mode interpolates, so that
/// few nodes suffice. A quantity with a value that is not positive is interpolated as it is.
///
/// ```
/// use kufe_lut::{Axes, Lookup, Mode, Quantity, Solved, Table};
/// let axes = Axes::new(vec![250.0, 2000.0], vec![0.0, 0.02], None)?;
/// let nodes = axes.points().iter().map(|point| {
///     let p_max = 1e8 * (point.fz / 1000.0).cbrt() * (1.0 - 10.0 * point.curvature);
///     Solved { p_max, p_max_error: 0.0, p_mean: p_max / 1.5, area: 1e-5, length: 0.05, width: 3e-4, approach: 1e-5, errors: None, sliding: None, method: Default::default() }
/// }).collect();
/// let lookup = Lookup::new(&Table::new(axes, nodes, vec![])?, Quantity::PMax, Mode::Smooth)?;
/// let looked = lookup.at(1000.0, 0.0);
/// assert!((looked.value / 1e8 - 1.0).abs() < 1e-12 && !looked.out_of_range);
/// assert!(lookup.at(9000.0, 0.0).out_of_range);
/// # Ok::<(), kufe_lut::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lookup {
    mode: Mode,
    pub(crate) fz: Axis,
    pub(crate) curvature: Axis,
    /// What the second axis' reduced curvatures stand for, where it holds such.
    flush: Option<Flush>,
    /// Plain values, rows of constant force.
    values: Vec<f64>,
    /// Smooth mode only: jets of the scaled values over the scaled axes.
    jets: Vec<Jet>,
    logarithmic: bool,
}

impl Lookup {
    /// One quantity of a table over force and curvature alone.
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] where the table has a rocker axis, and as [`Lookup::with_rocker`].
    pub fn new(table: &Table, quantity: Quantity, mode: Mode) -> Result<Self, Error> {
        Self::with_rocker(table, quantity, mode, None)
    }

    /// One quantity of a table at one rocker radius [m].
    ///
    /// A runner's rocker radius is fixed while it slides, so it is interpolated here, once: linearly in the
    /// plain values (bilinear mode, which equals Simulink's three-dimensional lookup) or in the
    /// logarithms of radius and quantity (smooth mode). Both keep the order of the data along the other axes.
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] where the table has a rocker axis and no radius is given,
    /// [`Error::RockerOutside`] where the radius is not on it or there is no such axis, [`Error::NoQuantity`] for what only a
    /// runner that slides has, [`Error::LayersNeeded`] where the table has speeds or temperatures: [`Layered`] takes those.
    ///
    /// [`Layered`]: crate::Layered
    pub fn with_rocker(
        table: &Table,
        quantity: Quantity,
        mode: Mode,
        rocker_radius: Option<f64>,
    ) -> Result<Self, Error> {
        if table.axes().is_sliding() {
            return Err(Error::LayersNeeded);
        }
        let (values, logarithmic) = at_rocker(table, quantity, mode, rocker_radius)?;
        Ok(Self::of_values(table.axes(), values, mode, logarithmic))
    }

    /// Of the values at all forces and curvatures of these axes.
    pub(crate) fn of_values(axes: &Axes, values: Vec<f64>, mode: Mode, logarithmic: bool) -> Self {
        let scale = |value: f64| if logarithmic { value.ln() } else { value };
        let fz = Axis::logarithmic(axes.fz());
        let curvature = Axis::plain(axes.curvature());
        debug_assert!(fz.plain.len() <= MAX_AXIS && curvature.plain.len() <= MAX_AXIS);
        let jets = match mode {
            Mode::Bilinear => Vec::new(),
            Mode::Smooth => {
                let scaled: Vec<f64> = values.iter().map(|&value| scale(value)).collect();
                jets(&fz.scaled, &curvature.scaled, &scaled)
            }
        };
        Lookup {
            mode,
            fz,
            curvature,
            flush: axes.flush().copied(),
            values,
            jets,
            logarithmic,
        }
    }

    /// The quantity at a force [N] and a curvature [1/m].
    ///
    /// Inputs outside the table are clipped to it and flagged; NaN gives NaN and the flag. Needs
    /// no allocation and at most `log2` of the axes' lengths in comparisons.
    #[inline]
    pub fn at(&self, fz: f64, curvature: f64) -> Looked {
        if fz.is_nan() || curvature.is_nan() {
            return Looked {
                value: f64::NAN,
                out_of_range: true,
            };
        }
        let (x, y) = self.places(fz, curvature);
        let value = match self.mode {
            Mode::Bilinear => self.bilinear(&x, &y),
            Mode::Smooth => self.smooth(&x, &y),
        };
        Looked {
            value,
            out_of_range: x.outside || y.outside,
        }
    }

    /// Where a force and a curvature, no NaN, lie.
    #[inline]
    pub(crate) fn places(&self, fz: f64, curvature: f64) -> (Place, Place) {
        let x = self.fz.place(fz);
        let y = self.curvature.place(match &self.flush {
            None => curvature,
            Some(flush) => flush.reduced(x.clipped, curvature),
        });
        (x, y)
    }

    #[inline]
    pub(crate) fn bilinear(&self, x: &Place, y: &Place) -> f64 {
        let columns = self.curvature.plain.len();
        let tx = fraction(&self.fz.plain, x, x.clipped);
        let ty = fraction(&self.curvature.plain, y, y.clipped);
        let (v00, v10) = (
            self.values[x.low * columns + y.low],
            self.values[x.high * columns + y.low],
        );
        let (v01, v11) = (
            self.values[x.low * columns + y.high],
            self.values[x.high * columns + y.high],
        );
        let left = v00 + (v10 - v00) * tx;
        let right = v01 + (v11 - v01) * tx;
        left + (right - left) * ty
    }

    #[inline]
    fn smooth(&self, x: &Place, y: &Place) -> f64 {
        let rise = self.rise(x, y);
        let start = self.values[self.corner(x, y)];
        if self.logarithmic {
            start * rise.exp()
        } else {
            start + rise
        }
    }

    /// The node at the lower corner of a cell.
    #[inline]
    pub(crate) fn corner(&self, x: &Place, y: &Place) -> usize {
        x.low * self.curvature.plain.len() + y.low
    }

    /// Hermite patch of the difference to the lower corner, so that nodes come out as they went in.
    #[inline]
    pub(crate) fn rise(&self, x: &Place, y: &Place) -> f64 {
        let columns = self.curvature.plain.len();
        let hx = self.fz.scaled[x.high] - self.fz.scaled[x.low];
        let hy = self.curvature.scaled[y.high] - self.curvature.scaled[y.low];
        let tx = fraction(&self.fz.scaled, x, x.clipped.ln());
        let ty = fraction(&self.curvature.scaled, y, y.clipped);
        let corner = |i: usize, j: usize| &self.jets[i * columns + j];
        let (a, b) = (corner(x.low, y.low), corner(x.high, y.low));
        let (c, d) = (corner(x.low, y.high), corner(x.high, y.high));
        let [x0, x1, x2] = hermite(tx, hx);
        let [y0, y1, y2] = hermite(ty, hy);
        // Along x on both grid lines: the value less f of corner `a`, and the slope along y.
        let low = (b.f - a.f) * x0 + a.fx * x1 + b.fx * x2;
        let high = (c.f - a.f) + ((d.f - c.f) * x0 + c.fx * x1 + d.fx * x2);
        let low_slope = a.fy + ((b.fy - a.fy) * x0 + a.fxy * x1 + b.fxy * x2);
        let high_slope = c.fy + ((d.fy - c.fy) * x0 + c.fxy * x1 + d.fxy * x2);
        low + ((high - low) * y0 + low_slope * y1 + high_slope * y2)
    }

    /// Mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether the table's second axis holds reduced curvatures.
    pub fn is_reduced(&self) -> bool {
        self.flush.is_some()
    }

    /// What the C code needs: plain values, jets (empty in bilinear mode) and whether they are of logarithms.
    pub(crate) fn parts(&self) -> (&[f64], &[Jet], bool) {
        (&self.values, &self.jets, self.logarithmic)
    }
}

/// Hermite weights of the far value and of both slopes.
#[inline]
pub(crate) fn hermite(t: f64, h: f64) -> [f64; 3] {
    let s = 1.0 - t;
    [t * t * (3.0 - 2.0 * t), h * t * s * s, -(h * t * t * s)]
}

/// The values of a quantity at all nodes of one rocker radius, and whether they are interpolated in logarithms.
pub(crate) fn at_rocker(
    table: &Table,
    quantity: Quantity,
    mode: Mode,
    rocker_radius: Option<f64>,
) -> Result<(Vec<f64>, bool), Error> {
    let values: Option<Vec<f64>> = table.nodes().iter().map(|n| n.get(quantity)).collect();
    let all = values.ok_or(Error::NoQuantity {
        quantity: quantity.name(),
    })?;
    let logarithmic = mode == Mode::Smooth && all.iter().all(|&value| value > 0.0);
    let (radii, radius) = match (table.axes().rocker_radius(), rocker_radius) {
        (None, None) => return Ok((all, logarithmic)),
        (Some(radii), None) => {
            return Err(Error::RockerNeeded {
                low: radii[0],
                high: radii[radii.len() - 1],
            });
        }
        (None, Some(value)) => {
            return Err(Error::RockerOutside {
                value,
                span: "one runner, without a rocker axis".into(),
            });
        }
        (Some(radii), Some(radius)) => (radii, radius),
    };
    let last = radii.len() - 1;
    if !(radii[0]..=radii[last]).contains(&radius) {
        return Err(Error::RockerOutside {
            value: radius,
            span: format!("{} to {} m", radii[0], radii[last]),
        });
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
    // Rocker radii are the slowest of what lies at one force and curvature.
    let inner = table.axes().layers() / radii.len();
    let lines = all.chunks_exact(radii.len() * inner);
    let at_radius = lines.flat_map(|line| {
        (0..inner).map(move |n| between(line[low * inner + n], line[high * inner + n]))
    });
    Ok((at_radius.collect(), logarithmic))
}
