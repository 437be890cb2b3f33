//! The grid that refinement grows: places on the axes, their middles, and points spread over them.

use crate::error::Error;
use crate::sweep::plan::{Plan, Spacing};
use crate::table::axes::Axes;
use crate::table::flush::Flush;
use crate::table::solved::Point;

/// Force, (reduced) curvature, rocker radius; without a rocker axis the radius is one value that is ignored.
pub(crate) type Place = [f64; 3];

/// The places on each axis.
pub(crate) struct Grid {
    pub values: [Vec<f64>; 3],
    /// Which axes may grow.
    pub refined: [bool; 3],
    flush: Option<Flush>,
    has_rocker: bool,
}

/// The middle of an interval as the sweep divides it: of logarithms of forces and radii, of plain curvatures.
pub(crate) fn middle(axis: usize, low: f64, high: f64) -> f64 {
    if axis == 1 {
        0.5 * (low + high)
    } else {
        (low * high).sqrt()
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

impl Grid {
    /// Five points on every range, the given ones elsewhere.
    ///
    /// # Errors
    /// [`Error::AxisValue`] for ranges that are none; [`Error::FlushValue`], [`Error::FlushPlan`].
    pub fn start(plan: &Plan) -> Result<Self, Error> {
        let spacings = [
            Some(&plan.fz),
            Some(&plan.curvature),
            plan.rocker_radius.as_ref(),
        ];
        let mut values: [Vec<f64>; 3] = Default::default();
        let mut refined = [false; 3];
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
        let flush = match (plan.flush, &plan.curvature, &plan.rocker_radius) {
            (None, ..) => None,
            (Some([curvature, scale]), &Spacing::Range { from, to }, None) => {
                values[1] = five(1, 0.0, 1.0)?;
                Some(Flush::new(curvature, scale, [from, to])?)
            }
            _ => return Err(Error::FlushPlan),
        };
        Ok(Grid {
            values,
            refined,
            flush,
            has_rocker: plan.rocker_radius.is_some(),
        })
    }

    pub fn axes(&self) -> Result<Axes, Error> {
        let [fz, curvature, rocker] = self.values.clone();
        match self.flush {
            None => Axes::new(fz, curvature, self.has_rocker.then_some(rocker)),
            Some(flush) => Axes::reduced(fz, curvature, flush),
        }
    }

    /// What is solved at a place.
    pub fn point(&self, [fz, curvature, radius]: Place) -> Point {
        Point {
            fz,
            curvature: match &self.flush {
                None => curvature,
                Some(flush) => flush.curvature(fz, curvature),
            },
            rocker_radius: self.has_rocker.then_some(radius),
        }
    }

    /// The nodes, in [`Axes::node`] order.
    pub fn nodes(&self) -> Vec<Place> {
        let [fz, curvature, rocker] = &self.values;
        let mut places = Vec::with_capacity(fz.len() * curvature.len() * rocker.len());
        for &a in fz {
            for &b in curvature {
                places.extend(rocker.iter().map(|&c| [a, b, c]));
            }
        }
        places
    }

    /// Middles of the intervals of every refined axis, on every other grid line.
    pub fn middles(&self) -> Vec<Place> {
        let sparse = |axis: usize| {
            let values = &self.values[axis];
            let last = values.len() - 1;
            let kept = move |i: &usize| i.is_multiple_of(2) || *i == last;
            (0..=last)
                .filter(kept)
                .map(|i| values[i])
                .collect::<Vec<_>>()
        };
        let mut places = Vec::new();
        for axis in (0..3).filter(|&axis| self.refined[axis]) {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for pair in self.values[axis].windows(2) {
                let mut at = [0.0; 3];
                at[axis] = middle(axis, pair[0], pair[1]);
                for &vb in &sparse(b) {
                    for &vc in &sparse(c) {
                        at[b] = vb;
                        at[c] = vc;
                        places.push(at);
                    }
                }
            }
        }
        places
    }

    /// Spread places; where an axis is given by its values, every other place lies on one of them, so that it
    /// measures the refined axes alone.
    pub fn spread(&self, count: usize) -> Vec<Place> {
        let mut places = spread(&self.values, count);
        for at in places.iter_mut().step_by(2) {
            for axis in (0..3).filter(|&axis| !self.refined[axis]) {
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
        let at = |i: usize| match axis {
            1 => values[i],
            _ => values[i].ln(),
        };
        let part = (at(k + 1) - at(k)) / (at(values.len() - 1) - at(0));
        part > 1.5 * smallest
    }
}

/// Five places from one end to the other, each in the middle of its neighbours.
fn five(axis: usize, from: f64, to: f64) -> Result<Vec<f64>, Error> {
    let wrong = |index, value, expected| Error::AxisValue {
        axis: ["fz_n", "curvature_1pm", "rocker_radius_m"][axis],
        index,
        value,
        expected,
    };
    // The ends are checked before anything is computed from them.
    let usable = |v: f64| v.is_finite() && (axis == 1 || v > 0.0);
    for (index, value) in [from, to].into_iter().enumerate() {
        if !usable(value) {
            let expected = "a finite number, positive for forces and radii";
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
/// effectiveness of quasirandom sequences, 2018) in the logarithms of forces and radii and in plain curvatures.
pub(crate) fn spread(values: &[Vec<f64>; 3], count: usize) -> Vec<Place> {
    // 1/g, 1/g^2, 1/g^3 for the root g of g^4 = g + 1.
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
    ];
    (1..=count)
        .map(|n| {
            std::array::from_fn(|axis| {
                let (first, last) = (values[axis][0], values[axis][values[axis].len() - 1]);
                if first == last {
                    return first;
                }
                let t = (0.5 + n as f64 * STEPS[axis]).fract();
                if axis == 1 {
                    first + t * (last - first)
                } else {
                    first * (last / first).powf(t)
                }
            })
        })
        .collect()
}
