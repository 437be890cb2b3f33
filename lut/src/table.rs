//! The table itself.

use serde_json::Value;

use crate::{Axes, Error, Lookup, Mode, Point, Quantity, Solved};

/// A solve that is not a node: what the interpolation is measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Where.
    pub point: Point,
    /// What the solver found there.
    pub solved: Solved,
}

/// Contact figures over normal force and track curvature, with what is needed to trust them.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Breakpoints.
    axes: Axes,
    /// Figures at the nodes, in [`Axes::node`] order.
    nodes: Vec<Solved>,
    /// Solves between the nodes.
    checks: Vec<Check>,
    /// Relative interpolation error of the peak pressure that was asked for, where one was.
    pub interpolation_asked: Option<f64>,
    /// The case whose load and track the axes replace.
    pub case: Value,
    /// SHA-256 of the case and of the hull it names, hexadecimal.
    pub case_sha256: String,
    /// Version of the program that solved the contacts.
    pub version: String,
}

/// Interpolation error of one quantity in one mode, measured at [`Table::checks`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Largest error relative to the solved value.
    pub max: f64,
    /// Root of the mean square of the relative errors.
    pub rms: f64,
    /// Where the largest one is.
    pub at: Point,
}

impl Table {
    /// A table from its nodes.
    ///
    /// # Errors
    /// [`Error::NodeCount`] where `nodes` does not fit `axes`, [`Error::NotFinite`] where a figure
    /// of a node or a check is no finite number.
    pub fn new(axes: Axes, nodes: Vec<Solved>, checks: Vec<Check>) -> Result<Self, Error> {
        if nodes.len() != axes.node_count() {
            return Err(Error::NodeCount {
                found: nodes.len(),
                expected: axes.node_count(),
            });
        }
        let points = axes.points();
        let all = points
            .iter()
            .zip(&nodes)
            .chain(checks.iter().map(|check| (&check.point, &check.solved)));
        for (point, solved) in all {
            finite(point, solved)?;
        }
        Ok(Table {
            axes,
            nodes,
            checks,
            interpolation_asked: None,
            case: Value::Null,
            case_sha256: String::new(),
            version: env!("CARGO_PKG_VERSION").to_string(),
        })
    }

    /// Breakpoints.
    pub fn axes(&self) -> &Axes {
        &self.axes
    }

    /// Figures at the nodes, in [`Axes::node`] order.
    pub fn nodes(&self) -> &[Solved] {
        &self.nodes
    }

    /// Solves between the nodes.
    pub fn checks(&self) -> &[Check] {
        &self.checks
    }

    /// Largest estimated solver error of the peak pressure over the nodes, relative.
    pub fn solver_error(&self) -> f64 {
        self.nodes
            .iter()
            .map(|node| node.p_max_error.abs() / node.p_max.abs())
            .fold(0.0, f64::max)
    }

    /// Interpolation error measured at the checks; `None` where there are none.
    ///
    /// # Errors
    /// As [`Lookup::new`].
    pub fn interpolation_error(
        &self,
        quantity: Quantity,
        mode: Mode,
    ) -> Result<Option<Measured>, Error> {
        let mut lookup: Option<(Option<f64>, Lookup)> = None;
        let mut worst: Option<Measured> = None;
        let mut squares = 0.0;
        for check in &self.checks {
            let radius = check.point.rocker_radius;
            if lookup.as_ref().is_none_or(|(of, _)| *of != radius) {
                lookup = Some((radius, Lookup::with_rocker(self, quantity, mode, radius)?));
            }
            let Some((_, lookup)) = &lookup else { continue };
            let error = relative_error(lookup, check, quantity);
            squares += error * error;
            if worst.is_none_or(|worst| error > worst.max) {
                worst = Some(Measured {
                    max: error,
                    rms: 0.0,
                    at: check.point,
                });
            }
        }
        Ok(worst.map(|worst| Measured {
            rms: (squares / self.checks.len() as f64).sqrt(),
            ..worst
        }))
    }
}

/// Error of an interpolated value relative to the solved one; where that is 0, the plain difference.
pub(crate) fn relative_error(lookup: &Lookup, check: &Check, quantity: Quantity) -> f64 {
    let truth = check.solved.get(quantity);
    let value = lookup.at(check.point.fz, check.point.curvature).value;
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    (value - truth).abs() / scale
}

pub(crate) fn finite(point: &Point, solved: &Solved) -> Result<(), Error> {
    for (value, key) in solved.to_array().into_iter().zip(Solved::KEYS) {
        if !value.is_finite() {
            return Err(Error::NotFinite {
                quantity: key,
                place: point.to_string(),
                value,
            });
        }
    }
    Ok(())
}
