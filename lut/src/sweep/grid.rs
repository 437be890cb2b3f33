//! The grid of a refinement: breakpoints, midpoints of intervals, and quasi-random points.

use crate::axes::{Axes, AxisKind, KINDS, Point};
use crate::error::Error;
use crate::reduced::CurvatureScaling;
use crate::sweep::plan::{Plan, Spacing};

/// Coordinates by kind of axis; the second one may be a reduced curvature. The coordinate of an
/// absent axis is ignored.
pub(crate) type Place = [f64; KINDS];

/// Replaces the coordinate along an axis.
fn with(mut place: Place, axis: usize, value: f64) -> Place {
    place[axis] = value;
    place
}

/// The breakpoints of each axis.
pub(crate) struct Grid {
    /// Breakpoints by kind of axis; for an absent axis a single one, which is ignored.
    pub values: [Vec<f64>; KINDS],
    /// Whether an axis is refined.
    pub refined: [bool; KINDS],
    flush: Option<CurvatureScaling>,
    /// Whether the plan has an axis.
    has: [bool; KINDS],
}

/// The midpoint of an interval: geometric mean of forces, radii and speeds, arithmetic mean of
/// curvatures and temperatures.
pub(crate) fn middle(axis: usize, low: f64, high: f64) -> f64 {
    if AxisKind::ALL[axis].is_logarithmic() {
        (low * high).sqrt()
    } else {
        0.5 * (low + high)
    }
}

impl Grid {
    /// Five breakpoints on every range, the given ones elsewhere.
    ///
    /// # Errors
    /// [`Error::Axis`] for ranges without extent; [`Error::Invalid`] for reduced curvatures that do
    /// not fit.
    pub fn start(plan: &Plan) -> Result<Self, Error> {
        let mut values: [Vec<f64>; KINDS] = Default::default();
        let mut refined = [false; KINDS];
        for (axis, kind) in AxisKind::ALL.into_iter().enumerate() {
            values[axis] = match plan.get(kind) {
                None => vec![0.0],
                Some(Spacing::Values(values)) => values.clone(),
                Some(&Spacing::Range { from, to }) => {
                    refined[axis] = true;
                    five(axis, from, to)?
                }
            };
        }
        let has = AxisKind::ALL.map(|kind| plan.get(kind).is_some());
        let alone = has == [true, true, false, false, false];
        let flush = match (plan.flush, plan.get(AxisKind::Curvature)) {
            (None, _) => None,
            (Some([curvature, scale]), Some(&Spacing::Range { from, to })) if alone => {
                values[1] = five(1, 0.0, 1.0)?;
                Some(CurvatureScaling::new(curvature, scale, [from, to])?)
            }
            _ => return Err(Error::flush_plan()),
        };
        Ok(Grid {
            values,
            refined,
            flush,
            has,
        })
    }

    /// The axes of the table with these breakpoints.
    pub fn axes(&self) -> Result<Axes, Error> {
        let [fz, curvature] = [0, 1].map(|axis| self.values[axis].clone());
        let mut axes = match self.flush {
            None => Axes::new(fz, curvature),
            Some(flush) => Axes::reduced(fz, curvature, flush),
        }?;
        for axis in (2..KINDS).filter(|&axis| self.has[axis]) {
            axes = axes.with(AxisKind::ALL[axis], self.values[axis].clone())?;
        }
        Ok(axes)
    }

    /// The point at a place.
    pub fn point(&self, place: Place) -> Point {
        let given = AxisKind::ALL.into_iter().zip(place).zip(self.has);
        let given = given.filter(|(_, has)| *has).map(|(pair, _)| pair);
        let mut point = given.fold(Point::default(), |point, (kind, value)| {
            point.with(kind, value)
        });
        if let Some(flush) = &self.flush {
            point.curvature = flush.curvature(point.fz, point.curvature);
        }
        point
    }

    /// The nodes, in the order of [`Axes::points`].
    pub fn nodes(&self) -> Vec<Place> {
        let all = self.values.each_ref();
        self.product(&all.map(|values| (0..values.len()).collect()))
    }

    /// The tensor product of these breakpoints of each axis, the last axis fastest.
    pub fn product(&self, breakpoints: &[Vec<usize>; KINDS]) -> Vec<Place> {
        let mut places: Vec<Place> = vec![[0.0; KINDS]];
        for (axis, indices) in breakpoints.iter().enumerate() {
            let wider = |place: Place| {
                let values = indices.iter().map(move |&i| self.values[axis][i]);
                values.map(move |value| with(place, axis, value))
            };
            places = places.into_iter().flat_map(wider).collect();
        }
        places
    }

    /// Midpoints of the intervals of every refined axis, on every second grid line.
    pub fn middles(&self) -> Vec<Place> {
        let sparse: [Vec<usize>; KINDS] = self.values.each_ref().map(|values| {
            let last = values.len() - 1;
            let sparse = |i: &usize| i.is_multiple_of(2) || *i == last;
            (0..=last).filter(sparse).collect()
        });
        let mut places = Vec::new();
        for axis in (0..KINDS).filter(|&axis| self.refined[axis]) {
            let mut across = sparse.clone();
            across[axis] = vec![0];
            let lines = self.product(&across);
            for pair in self.values[axis].windows(2) {
                let centre = middle(axis, pair[0], pair[1]);
                places.extend(lines.iter().map(|line| with(*line, axis, centre)));
            }
        }
        places
    }

    /// Quasi-random places. Every second place is moved to a breakpoint of each axis with given
    /// values, so that it measures the refined axes alone.
    pub fn spread(&self, count: usize) -> Vec<Place> {
        let mut places = spread(&self.values, count);
        for at in places.iter_mut().step_by(2) {
            for axis in (0..KINDS).filter(|&axis| !self.refined[axis]) {
                let values = &self.values[axis];
                let above = values.partition_point(|&v| v < at[axis]);
                at[axis] = values[above.min(values.len() - 1)];
            }
        }
        places
    }

    /// The interval of an axis that contains a value.
    pub fn interval(&self, axis: usize, value: f64) -> usize {
        let values = &self.values[axis];
        let after = values.partition_point(|&v| v <= value);
        after.clamp(1, values.len() - 1) - 1
    }

    /// Whether interval `k` may be halved: whether it is longer than 1.5 times `smallest`, a
    /// fraction of the axis.
    pub fn divisible(&self, axis: usize, k: usize, smallest: f64) -> bool {
        let values = &self.values[axis];
        let at = |i: usize| AxisKind::ALL[axis].scaled(values[i]);
        let part = (at(k + 1) - at(k)) / (at(values.len() - 1) - at(0));
        part > 1.5 * smallest
    }
}

/// Five breakpoints from one end to the other, each at the midpoint of its neighbours.
fn five(axis: usize, from: f64, to: f64) -> Result<Vec<f64>, Error> {
    let wrong = |index, value, expected| {
        Error::axis_value(AxisKind::ALL[axis].key(), index, value, expected)
    };
    // Checked before the midpoints are computed.
    let usable = |v: f64| v.is_finite() && (v > 0.0 || !AxisKind::ALL[axis].is_logarithmic());
    for (index, value) in [from, to].into_iter().enumerate() {
        if !usable(value) {
            let expected = "a finite number, positive for forces, radii and speeds";
            return Err(wrong(index, value, expected));
        }
    }
    if to <= from {
        return Err(wrong(1, to, "a value above where the range starts"));
    }
    let centre = middle(axis, from, to);
    let (low, high) = (middle(axis, from, centre), middle(axis, centre, to));
    Ok(vec![from, low, centre, high, to])
}

/// `count` quasi-random places between the ends of the axes: the R2 sequence (M. Roberts, The
/// unreasonable effectiveness of quasirandom sequences, 2018) in the logarithms of forces, radii
/// and speeds, and in curvatures and temperatures.
pub(crate) fn spread(values: &[Vec<f64>; KINDS], count: usize) -> Vec<Place> {
    // Powers of 1/g for the root g of g^4 = g + 1, and of g^6 = g + 1 for more than three axes.
    const THREE: [f64; KINDS] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
        0.0,
        0.0,
    ];
    const FIVE: [f64; KINDS] = [
        0.881_271_461_633_569_6,
        0.776_639_389_089_768_2,
        0.684_430_129_585_342_6,
        0.603_168_740_685_728_2,
        0.531_555_397_715_791_3,
    ];
    let further = values[3].len().max(values[4].len()) > 1;
    let steps = if further { FIVE } else { THREE };
    let coordinate = |n: usize, axis: usize| {
        let (first, last) = (values[axis][0], values[axis][values[axis].len() - 1]);
        let t = (0.5 + n as f64 * steps[axis]).fract();
        if first == last {
            first
        } else if AxisKind::ALL[axis].is_logarithmic() {
            first * (last / first).powf(t)
        } else {
            first + t * (last - first)
        }
    };
    let place = |n| std::array::from_fn(|axis| coordinate(n, axis));
    (1..=count).map(place).collect()
}
