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
/// Nodes are numbered with `fz` slowest and `rocker_radius` fastest:
/// `(i * curvature.len() + j) * rockers + k`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    fz: Vec<f64>,
    curvature: Vec<f64>,
    flush: Option<Flush>,
    rocker_radius: Option<Vec<f64>>,
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
        let axes = Axes {
            fz,
            curvature,
            flush: None,
            rocker_radius,
        };
        let found = axes.node_count();
        if found > MAX_NODES {
            return Err(Error::TooManyNodes {
                found,
                limit: MAX_NODES,
            });
        }
        Ok(axes)
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

    /// Number of breakpoints on the rocker axis, 1 without it.
    pub fn rockers(&self) -> usize {
        self.rocker_radius.as_ref().map_or(1, Vec::len)
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.fz.len() * self.curvature.len() * self.rockers()
    }

    /// Number of the node at breakpoints `i` (force), `j` (curvature), `k` (rocker).
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (i * self.curvature.len() + j) * self.rockers() + k
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
        let k = match (&self.rocker_radius, point.rocker_radius) {
            (Some(radii), Some(radius)) => cell(radii, radius),
            _ => [0, 0],
        };
        (0..8usize).map(move |n| self.node(i[n & 1], j[(n >> 1) & 1], k[n >> 2]))
    }

    /// All nodes in their order.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(self.node_count());
        for &fz in &self.fz {
            for &place in &self.curvature {
                let curvature = self.curvature_at(fz, place);
                match &self.rocker_radius {
                    None => points.push(Point {
                        fz,
                        curvature,
                        rocker_radius: None,
                    }),
                    Some(radii) => points.extend(radii.iter().map(|&radius| Point {
                        fz,
                        curvature,
                        rocker_radius: Some(radius),
                    })),
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
