//! The plan of a sweep: the breakpoints of each axis, and the accuracy of the table.

use crate::axes::{AxisKind, KINDS, Point};
use crate::error::Error;
use crate::interpolator::Mode;
use crate::sweep::grid::Grid;

/// Breakpoints of an axis: given, or placed by refinement.
#[derive(Clone, Debug, PartialEq)]
pub enum Spacing {
    /// Given breakpoints.
    Values(Vec<f64>),
    /// As many breakpoints between these ends as the tolerance needs.
    Range {
        /// First breakpoint.
        from: f64,
        /// Last breakpoint.
        to: f64,
    },
}

impl Spacing {
    /// The given values, or both ends of the range.
    pub fn ends(&self) -> Vec<f64> {
        match self {
            Spacing::Values(values) => values.clone(),
            Spacing::Range { from, to } => vec![*from, *to],
        }
    }
}

/// Axes, accuracy and limits of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Spacings by kind of axis.
    axes: [Option<Spacing>; KINDS],
    /// The curvature at which the runner lies flush [1/m] and the scale [1/(m N)], see
    /// [`crate::CurvatureScaling`]. The second axis of the table then has reduced curvatures. It
    /// requires a range of curvatures and no further axis.
    pub flush: Option<[f64; 2]>,
    /// Relative interpolation error of [`Table::judged`](crate::Table::judged), requested of every
    /// mode in `modes`.
    pub interpolation: f64,
    /// The modes with this accuracy.
    pub modes: Vec<Mode>,
    /// Largest number of nodes of a refinement.
    pub max_nodes: usize,
    /// Smallest interval, as a fraction of its axis; it limits the refinement at a kink of the
    /// data.
    pub smallest_interval: f64,
    /// Number of quasi-random solves that measure the interpolation, in addition to those of the
    /// refinement.
    pub checks: usize,
}

impl Plan {
    /// A plan over forces [N] and curvatures [1/m] that requests 1 % of both modes, measured at 200
    /// spread points, and places at most 20 000 nodes, none closer than 1/65536 of an axis.
    ///
    /// If both axes are given by their values, the number of checks is an eighth of the number of
    /// nodes, at least 4.
    pub fn new(fz: Spacing, curvature: Spacing) -> Self {
        let checks = match (&fz, &curvature) {
            (Spacing::Values(fz), Spacing::Values(curvature)) => {
                (fz.len() * curvature.len()).div_ceil(8).max(4)
            }
            _ => 200,
        };
        Plan {
            axes: [Some(fz), Some(curvature), None, None, None],
            checks,
            flush: None,
            interpolation: 0.01,
            modes: Mode::ALL.to_vec(),
            max_nodes: 20_000,
            smallest_interval: 1.0 / 65536.0,
        }
    }

    /// Sets the spacing along an axis. Without it, rocker radius, speed and temperature are those
    /// of the case.
    #[must_use]
    pub fn with(mut self, kind: AxisKind, spacing: Spacing) -> Self {
        self.axes[kind as usize] = Some(spacing);
        self
    }

    /// The spacing along an axis; `None` if the plan does not have it.
    pub fn get(&self, kind: AxisKind) -> Option<&Spacing> {
        self.axes[kind as usize].as_ref()
    }

    /// Whether every axis is given by its values.
    pub fn is_fixed(&self) -> bool {
        let mut spacings = self.axes.iter().flatten();
        spacings.all(|spacing| matches!(spacing, Spacing::Values(_)))
    }

    /// Whether it has an axis that only a sliding runner has.
    pub fn is_sliding(&self) -> bool {
        let mut kinds = AxisKind::ALL.into_iter();
        kinds.any(|kind| kind.is_sliding() && self.get(kind).is_some())
    }

    /// Checks the axes before the first solve.
    ///
    /// # Errors
    /// [`Error::Axis`], and [`Error::Invalid`] for too many nodes or reduced curvatures that do not
    /// fit.
    pub fn check(&self) -> Result<(), Error> {
        Grid::start(self)?.axes().map(|_| ())
    }

    /// The nodes at the corners and in the middle of the table, which every sweep solves.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn anchors(&self) -> Result<Vec<Point>, Error> {
        let grid = Grid::start(self)?;
        let counts = grid.values.each_ref().map(Vec::len);
        let ends = counts.map(|count| match count {
            1 => vec![0],
            count => vec![0, count - 1],
        });
        let middle = counts.map(|count| vec![count / 2]);
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
