//! The grid that refinement grows: places on the axes, their middles, and points spread over them.

use crate::error::Error;
use crate::sweep::plan::{AXES, Plan, Spacing};
use crate::table::axes::Axes;
use crate::table::flush::Flush;
use crate::table::solved::Point;

/// Force, (reduced) curvature, rocker radius, speed, temperature of the ice; an axis that is not there has one value that is
/// ignored.
pub(crate) type Place = [f64; AXES];

/// Keys of the axes.
const NAMES: [&str; AXES] = ["fz_n", "curvature_1pm", "rocker_radius_m", "v_mps", "ice_c"];

/// Axes that are divided in logarithms; their values are positive.
const LOGARITHMIC: [bool; AXES] = [true, false, true, true, false];

/// The places on each axis.
pub(crate) struct Grid {
    pub values: [Vec<f64>; AXES],
    /// Which axes may grow.
    pub refined: [bool; AXES],
    flush: Option<Flush>,
    /// Which axes the plan has.
    has: [bool; AXES],
}

/// The middle of an interval as the sweep divides it: of logarithms of forces, radii and speeds, of plain curvatures and
/// temperatures.
pub(crate) fn middle(axis: usize, low: f64, high: f64) -> f64 {
    if LOGARITHMIC[axis] {
        (low * high).sqrt()
    } else {
        0.5 * (low + high)
    }
}

impl Plan {
    /// Checks the axes, before anything is solved.
    ///
    /// # Errors
    /// [`Error::AxisLength`], [`Error::AxisValue`], [`Error::TooManyNodes`], [`Error::FlushValue`], [`Error::FlushPlan`].
    pub fn check(&self) -> Result<(), Error> {
        Grid::start(self)?.axes().map(|_| ())
    }
}

impl Plan {
    /// The nodes at the corners of what is asked, and the one in its middle: each is solved in any case.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn anchors(&self) -> Result<Vec<Point>, Error> {
        let grid = Grid::start(self)?;
        let ends = std::array::from_fn(|axis| match grid.values[axis].len() {
            1 => vec![0],
            count => vec![0, count - 1],
        });
        let middle = std::array::from_fn(|axis| vec![grid.values[axis].len() / 2]);
        let mut anchors: Vec<Point> = Vec::new();
        for place in [ends, middle].iter().flat_map(|at| grid.product(at)) {
            let point = grid.point(place);
            if !anchors.contains(&point) {
                anchors.push(point);
            }
        }
        Ok(anchors)
    }
}

impl Grid {
    /// Five points on every range, the given ones elsewhere.
    ///
    /// # Errors
    /// [`Error::AxisValue`] for ranges that are none; [`Error::FlushValue`], [`Error::FlushPlan`].
    pub fn start(plan: &Plan) -> Result<Self, Error> {
        let spacings = plan.spacings();
        let mut values: [Vec<f64>; AXES] = Default::default();
        let mut refined = [false; AXES];
        for (axis, spacing) in spacings.into_iter().enumerate() {
            values[axis] = match spacing {
                None => vec![0.0],
                Some(Spacing::Values(values)) => values.clone(),
                Some(&Spacing::Range { from, to }) => {
                    refined[axis] = true;
                    five(axis, from, to)?
                }
            };
        }
        let has = spacings.map(|spacing| spacing.is_some());
        let alone = has == [true, true, false, false, false];
        let flush = match (plan.flush, &plan.curvature) {
            (None, _) => None,
            (Some([curvature, scale]), &Spacing::Range { from, to }) if alone => {
                values[1] = five(1, 0.0, 1.0)?;
                Some(Flush::new(curvature, scale, [from, to])?)
            }
            _ => return Err(Error::FlushPlan),
        };
        Ok(Grid {
            values,
            refined,
            flush,
            has,
        })
    }

    pub fn axes(&self) -> Result<Axes, Error> {
        let [fz, curvature, rocker, speed, ice] = self.values.clone();
        let [_, _, has_rocker, has_speed, has_ice] = self.has;
        let axes = match self.flush {
            None => Axes::new(fz, curvature, has_rocker.then_some(rocker)),
            Some(flush) => Axes::reduced(fz, curvature, flush),
        }?;
        axes.sliding(has_speed.then_some(speed), has_ice.then_some(ice))
    }

    /// What is solved at a place.
    pub fn point(&self, place: Place) -> Point {
        let [fz, curvature, ..] = place;
        let of = |axis: usize| self.has[axis].then_some(place[axis]);
        Point {
            fz,
            curvature: match &self.flush {
                None => curvature,
                Some(flush) => flush.curvature(fz, curvature),
            },
            rocker_radius: of(2),
            speed: of(3),
            ice_c: of(4),
        }
    }

    /// The nodes, in [`Axes::node`] order.
    pub fn nodes(&self) -> Vec<Place> {
        let all: [Vec<usize>; AXES] =
            std::array::from_fn(|axis| (0..self.values[axis].len()).collect());
        self.product(&all)
    }

    /// The places at these breakpoints of each axis, the last axis fastest.
    fn product(&self, breakpoints: &[Vec<usize>; AXES]) -> Vec<Place> {
        let mut places: Vec<Place> = vec![[0.0; AXES]];
        for (axis, indices) in breakpoints.iter().enumerate() {
            let wider = places.iter().flat_map(|&place| {
                indices.iter().map(move |&i| {
                    let mut at = place;
                    at[axis] = self.values[axis][i];
                    at
                })
            });
            places = wider.collect();
        }
        places
    }

    /// Middles of the intervals of every refined axis, on every other grid line.
    pub fn middles(&self) -> Vec<Place> {
        let sparse: [Vec<usize>; AXES] = std::array::from_fn(|axis| {
            let last = self.values[axis].len() - 1;
            let kept = |i: &usize| i.is_multiple_of(2) || *i == last;
            (0..=last).filter(kept).collect()
        });
        let mut places = Vec::new();
        for axis in (0..AXES).filter(|&axis| self.refined[axis]) {
            let mut across = sparse.clone();
            across[axis] = vec![0];
            let lines = self.product(&across);
            for pair in self.values[axis].windows(2) {
                let centre = middle(axis, pair[0], pair[1]);
                places.extend(lines.iter().map(|&line| {
                    let mut at = line;
                    at[axis] = centre;
                    at
                }));
            }
        }
        places
    }

    /// Spread places; where an axis is given by its values, every other place lies on one of them, so that it
    /// measures the refined axes alone.
    pub fn spread(&self, count: usize) -> Vec<Place> {
        let mut places = spread(&self.values, count);
        for at in places.iter_mut().step_by(2) {
            for axis in (0..AXES).filter(|&axis| !self.refined[axis]) {
                let values = &self.values[axis];
                let above = values.partition_point(|&v| v < at[axis]);
                at[axis] = values[above.min(values.len() - 1)];
            }
        }
        places
    }

    /// The interval of an axis that holds a value.
    pub fn interval(&self, axis: usize, value: f64) -> usize {
        let values = &self.values[axis];
        values
            .partition_point(|&v| v <= value)
            .clamp(1, values.len() - 1)
            - 1
    }

    /// Whether halves of interval `k` are no smaller than `smallest`, a part of the axis.
    pub fn divisible(&self, axis: usize, k: usize, smallest: f64) -> bool {
        let values = &self.values[axis];
        let at = |i: usize| match LOGARITHMIC[axis] {
            true => values[i].ln(),
            false => values[i],
        };
        let part = (at(k + 1) - at(k)) / (at(values.len() - 1) - at(0));
        part > 1.5 * smallest
    }
}

/// Five places from one end to the other, each in the middle of its neighbours.
fn five(axis: usize, from: f64, to: f64) -> Result<Vec<f64>, Error> {
    let wrong = |index, value, expected| Error::AxisValue {
        axis: NAMES[axis],
        index,
        value,
        expected,
    };
    // The ends are checked before anything is computed from them.
    let usable = |v: f64| v.is_finite() && (v > 0.0 || !LOGARITHMIC[axis]);
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

/// `count` places spread evenly between the ends of the axes: the R2 sequence (M. Roberts, The unreasonable
/// effectiveness of quasirandom sequences, 2018) in the logarithms of forces, radii and speeds and in plain curvatures and
/// temperatures.
pub(crate) fn spread(values: &[Vec<f64>; AXES], count: usize) -> Vec<Place> {
    // Powers of 1/g for the root g of g^4 = g + 1, and of g^6 = g + 1 where there are more than three axes.
    const THREE: [f64; AXES] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
        0.0,
        0.0,
    ];
    const FIVE: [f64; AXES] = [
        0.881_271_461_633_569_6,
        0.776_639_389_089_768_2,
        0.684_430_129_585_342_6,
        0.603_168_740_685_728_2,
        0.531_555_397_715_791_3,
    ];
    let steps = if values[3].len().max(values[4].len()) > 1 {
        FIVE
    } else {
        THREE
    };
    (1..=count)
        .map(|n| {
            std::array::from_fn(|axis| {
                let (first, last) = (values[axis][0], values[axis][values[axis].len() - 1]);
                if first == last {
                    return first;
                }
                let t = (0.5 + n as f64 * steps[axis]).fract();
                if LOGARITHMIC[axis] {
                    first * (last / first).powf(t)
                } else {
                    first + t * (last - first)
                }
            })
        })
        .collect()
}
