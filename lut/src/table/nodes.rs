//! The table itself.

use serde_json::Value;

use crate::error::Error;
use crate::table::axes::Axes;
use crate::table::solved::{Point, Solved};

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
