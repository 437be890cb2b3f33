//! What is swept, and what solves it.

use crate::table::mode::Mode;
use crate::table::solved::{Point, Solved};

/// Axes that a sweep may have: force, curvature, rocker radius, speed, temperature of the ice.
pub(crate) const AXES: usize = 5;

/// How one axis gets its breakpoints.
#[derive(Clone, Debug, PartialEq)]
pub enum Spacing {
    /// Just these.
    Values(Vec<f64>),
    /// As many between these ends as the tolerance needs.
    Range {
        /// First breakpoint.
        from: f64,
        /// Last breakpoint.
        to: f64,
    },
}

/// What is swept.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Normal forces [N].
    pub fz: Spacing,
    /// Track curvatures [1/m].
    pub curvature: Spacing,
    /// Where the runner lies flush: its curvature [1/m] and scale [1/(m N)], see [`crate::Flush`]. The table's second axis
    /// then holds reduced curvatures; needs a range of curvatures and no rocker axis.
    pub flush: Option<[f64; 2]>,
    /// Rocker radii [m]; `None`: the case's own runner.
    pub rocker_radius: Option<Spacing>,
    /// Speeds [m/s]; `None`: the case's own. Only a runner that slides has one.
    pub speed: Option<Spacing>,
    /// Temperatures of the ice [C]; `None`: the case's own. As `speed`.
    pub ice_c: Option<Spacing>,
    /// Relative interpolation error of [`Table::judged`](crate::Table::judged), asked of every mode in `modes`.
    pub interpolation: f64,
    /// The modes that must be that good.
    pub modes: Vec<Mode>,
    /// Most nodes that refinement may place.
    pub max_nodes: usize,
    /// Smallest interval, as a part of its axis: what a kink of the data is narrowed down to.
    pub smallest_interval: f64,
    /// Solves spread over the table that measure the interpolation besides those that refinement makes.
    pub checks: usize,
}

impl Plan {
    /// A plan that asks 1 % of both modes, measured at 200 spread points, and places at most 20 000 nodes, none closer than
    /// 1/65536 of an axis.
    ///
    /// Where both axes are given by their values, as many checks as an eighth of the nodes, at least 4.
    pub fn new(fz: Spacing, curvature: Spacing) -> Self {
        let checks = match (&fz, &curvature) {
            (Spacing::Values(fz), Spacing::Values(curvature)) => {
                (fz.len() * curvature.len()).div_ceil(8).max(4)
            }
            _ => 200,
        };
        Plan {
            checks,
            fz,
            curvature,
            flush: None,
            rocker_radius: None,
            speed: None,
            ice_c: None,
            interpolation: 0.01,
            modes: Mode::ALL.to_vec(),
            max_nodes: 20_000,
            smallest_interval: 1.0 / 65536.0,
        }
    }

    /// Whether every axis is given by its values.
    pub fn is_fixed(&self) -> bool {
        let mut spacings = self.spacings().into_iter().flatten();
        spacings.all(|spacing| matches!(spacing, Spacing::Values(_)))
    }

    /// Whether it has an axis that only a runner that slides knows.
    pub fn is_sliding(&self) -> bool {
        self.speed.is_some() || self.ice_c.is_some()
    }

    /// The axes in the order of the nodes.
    pub(crate) fn spacings(&self) -> [Option<&Spacing>; AXES] {
        [
            Some(&self.fz),
            Some(&self.curvature),
            self.rocker_radius.as_ref(),
            self.speed.as_ref(),
            self.ice_c.as_ref(),
        ]
    }
}

/// Solves a batch of points, results in their order.
pub(crate) type SolveBatch<'a, E> = dyn FnMut(&[Point]) -> Result<Vec<Solved>, E> + 'a;
