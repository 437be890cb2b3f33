//! The breakpoints of a table.

use crate::error::Error;
use crate::table::flush::Flush;
use crate::table::solved::Point;

/// Longest axis of a table.
pub const MAX_AXIS: usize = 4096;
/// Most nodes of a table.
pub const MAX_NODES: usize = 1 << 20;

/// Breakpoints, strictly increasing on every axis.
///
/// Nodes are numbered with `fz` slowest, then `curvature`, `rocker_radius`, `speed` and `ice_c`, as far as there are such axes:
/// `(i * curvature.len() + j) * layers + k`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    fz: Vec<f64>,
    curvature: Vec<f64>,
    flush: Option<Flush>,
    rocker_radius: Option<Vec<f64>>,
    speed: Option<Vec<f64>>,
    ice_c: Option<Vec<f64>>,
}

impl Axes {
    /// Axes from their breakpoints.
    ///
    /// # Errors
    /// [`Error::AxisLength`], [`Error::AxisValue`] and [`Error::TooManyNodes`] where an axis is
    /// empty or too long, a value is not finite, not above the one before, or (forces and rocker
    /// radii) not positive, or where there are more than [`MAX_NODES`] nodes.
    pub fn new(
        fz: Vec<f64>,
        curvature: Vec<f64>,
        rocker_radius: Option<Vec<f64>>,
    ) -> Result<Self, Error> {
        check("fz_n", &fz, true)?;
        check("curvature_1pm", &curvature, false)?;
        if let Some(radii) = &rocker_radius {
            check("rocker_radius_m", radii, true)?;
        }
        Axes {
            fz,
            curvature,
            flush: None,
            rocker_radius,
            speed: None,
            ice_c: None,
        }
        .few_enough()
    }

    /// The axes with speeds [m/s] and temperatures of the ice [C] besides.
    ///
    /// # Errors
    /// As [`Axes::new`], speeds being positive; [`Error::FlushPlan`] beside reduced curvatures.
    pub fn sliding(self, speed: Option<Vec<f64>>, ice_c: Option<Vec<f64>>) -> Result<Self, Error> {
        if self.flush.is_some() && (speed.is_some() || ice_c.is_some()) {
            return Err(Error::FlushPlan);
        }
        if let Some(speeds) = &speed {
            check("v_mps", speeds, true)?;
        }
        if let Some(temperatures) = &ice_c {
            check("ice_c", temperatures, false)?;
        }
        Axes {
            speed,
            ice_c,
            ..self
        }
        .few_enough()
    }

    fn few_enough(self) -> Result<Self, Error> {
        let lengths = self.named().into_iter().map(|(_, _, values)| values.len());
        let found = lengths.fold(1usize, usize::saturating_mul);
        if found > MAX_NODES {
            return Err(Error::TooManyNodes {
                found,
                limit: MAX_NODES,
            });
        }
        Ok(self)
    }

    /// Axes whose second one holds reduced curvatures.
    ///
    /// # Errors
    /// As [`Axes::new`]; [`Error::AxisValue`] where a reduced curvature is not between 0 and 1.
    pub fn reduced(fz: Vec<f64>, reduced: Vec<f64>, flush: Flush) -> Result<Self, Error> {
        if let Some(index) = reduced.iter().position(|t| !(0.0..=1.0).contains(t)) {
            return Err(Error::AxisValue {
                axis: "reduced_curvature",
                index,
                value: reduced[index],
                expected: "a number between 0 and 1",
            });
        }
        let mut axes = Axes::new(fz, reduced, None)?;
        axes.flush = Some(flush);
        Ok(axes)
    }

    /// Normal forces [N].
    pub fn fz(&self) -> &[f64] {
        &self.fz
    }

    /// Track curvatures, positive in a valley [1/m]; reduced ones, from 0 to 1, where [`Axes::flush`] says so.
    pub fn curvature(&self) -> &[f64] {
        &self.curvature
    }

    /// What the reduced curvatures stand for, where the second axis holds such.
    pub fn flush(&self) -> Option<&Flush> {
        self.flush.as_ref()
    }

    /// The track curvature [1/m] at a force [N] and a place on the second axis.
    pub fn curvature_at(&self, fz: f64, place: f64) -> f64 {
        self.flush.map_or(place, |flush| flush.curvature(fz, place))
    }

    /// Smallest and largest track curvature at a force [1/m].
    pub fn curvature_range(&self, fz: f64) -> [f64; 2] {
        [self.curvature[0], self.curvature[self.curvature.len() - 1]]
            .map(|place| self.curvature_at(fz, place))
    }

    /// Rocker radii where the table has that axis [m].
    pub fn rocker_radius(&self) -> Option<&[f64]> {
        self.rocker_radius.as_deref()
    }

    /// Speeds where the table has that axis [m/s].
    pub fn speed(&self) -> Option<&[f64]> {
        self.speed.as_deref()
    }

    /// Temperatures of the ice where the table has that axis [C].
    pub fn ice_c(&self) -> Option<&[f64]> {
        self.ice_c.as_deref()
    }

    /// Whether the table has an axis that only a runner that slides knows.
    pub fn is_sliding(&self) -> bool {
        self.speed.is_some() || self.ice_c.is_some()
    }

    /// Name, unit and breakpoints of every axis, in the order of the nodes.
    pub fn named(&self) -> Vec<(&'static str, &'static str, &[f64])> {
        let (name, unit) = match self.flush {
            None => ("curvature_1pm", "1/m"),
            Some(_) => ("reduced_curvature", "1"),
        };
        let mut axes = vec![("fz_n", "N", self.fz()), (name, unit, self.curvature())];
        axes.extend(self.rocker_radius().map(|v| ("rocker_radius_m", "m", v)));
        axes.extend(self.speed().map(|v| ("v_mps", "m/s", v)));
        axes.extend(self.ice_c().map(|v| ("ice_c", "C", v)));
        axes
    }

    /// Numbers of breakpoints of rocker radius, speed and temperature of the ice, 1 without the axis.
    pub(crate) fn inner(&self) -> [usize; 3] {
        [&self.rocker_radius, &self.speed, &self.ice_c]
            .map(|axis| axis.as_ref().map_or(1, Vec::len))
    }

    /// Number of nodes at one force and curvature.
    pub fn layers(&self) -> usize {
        self.inner().iter().product()
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.fz.len() * self.curvature.len() * self.layers()
    }

    /// Number of the node at breakpoints `i` (force), `j` (curvature) and at `k` among those of one force and curvature.
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (i * self.curvature.len() + j) * self.layers() + k
    }

    /// The corners of the cell that holds a point; a corner may come more than once.
    pub(crate) fn around(&self, point: &Point) -> impl Iterator<Item = usize> + use<'_> {
        let cell = |axis: &[f64], value: f64| {
            let high = axis.partition_point(|&v| v < value).min(axis.len() - 1);
            [high.saturating_sub(1), high]
        };
        let i = cell(&self.fz, point.fz);
        let place = match &self.flush {
            None => point.curvature,
            Some(flush) => flush.reduced(point.fz, point.curvature),
        };
        let j = cell(&self.curvature, place);
        let inner = |axis: &Option<Vec<f64>>, value: Option<f64>| match (axis, value) {
            (Some(axis), Some(value)) => cell(axis, value),
            _ => [0, 0],
        };
        let rocker = inner(&self.rocker_radius, point.rocker_radius);
        let speed = inner(&self.speed, point.speed);
        let ice = inner(&self.ice_c, point.ice_c);
        let [_, speeds, temperatures] = self.inner();
        (0..32usize).map(move |n| {
            let of = |cell: [usize; 2], bit: u32| cell[(n >> bit) & 1];
            let k = (of(rocker, 2) * speeds + of(speed, 3)) * temperatures + of(ice, 4);
            self.node(of(i, 0), of(j, 1), k)
        })
    }

    /// All nodes in their order.
    pub fn points(&self) -> Vec<Point> {
        let inner = |axis: &Option<Vec<f64>>| match axis {
            None => vec![None],
            Some(values) => values.iter().copied().map(Some).collect(),
        };
        let [rockers, speeds, temperatures] =
            [&self.rocker_radius, &self.speed, &self.ice_c].map(inner);
        let mut points = Vec::with_capacity(self.node_count());
        for &fz in &self.fz {
            for &place in &self.curvature {
                let curvature = self.curvature_at(fz, place);
                for &rocker_radius in &rockers {
                    for &speed in &speeds {
                        points.extend(temperatures.iter().map(|&ice_c| Point {
                            fz,
                            curvature,
                            rocker_radius,
                            speed,
                            ice_c,
                        }));
                    }
                }
            }
        }
        points
    }
}

fn check(axis: &'static str, values: &[f64], positive: bool) -> Result<(), Error> {
    if values.is_empty() || values.len() > MAX_AXIS {
        return Err(Error::AxisLength {
            axis,
            found: values.len(),
            limit: MAX_AXIS,
        });
    }
    let wrong = |index, expected| Error::AxisValue {
        axis,
        index,
        value: values[index],
        expected,
    };
    for (index, &value) in values.iter().enumerate() {
        if !value.is_finite() {
            return Err(wrong(index, "a finite number"));
        }
        if positive && value <= 0.0 {
            return Err(wrong(index, "a positive number"));
        }
        if index > 0 && value <= values[index - 1] {
            return Err(wrong(index, "a value above the one before"));
        }
    }
    Ok(())
}
