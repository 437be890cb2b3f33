//! The table itself.

use serde_json::Value;

use crate::error::Error;
use crate::table::axes::Axes;
use crate::table::quantity::Quantity;
use crate::table::solved::{Method, Point, Solved};

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
    /// of a node or a check is no finite number, [`Error::SlidingMixture`] where some slide and others do not.
    pub fn new(axes: Axes, nodes: Vec<Solved>, checks: Vec<Check>) -> Result<Self, Error> {
        let (mut nodes, mut checks) = (nodes, checks);
        if nodes.len() != axes.node_count() {
            return Err(Error::NodeCount {
                found: nodes.len(),
                expected: axes.node_count(),
            });
        }
        let points = axes.points();
        let sliding = axes.is_sliding() || nodes[0].sliding.is_some();
        let all = points
            .iter()
            .zip(&nodes)
            .chain(checks.iter().map(|check| (&check.point, &check.solved)));
        for (point, solved) in all {
            finite(point, solved)?;
            if solved.sliding.is_some() != sliding {
                return Err(Error::SlidingMixture {
                    place: point.to_string(),
                });
            }
        }
        let solved = checks.iter_mut().map(|check| &mut check.solved);
        let all: Vec<&mut Solved> = nodes.iter_mut().chain(solved).collect();
        // Errors that some lack are none of the table.
        if all.iter().any(|solved| solved.errors.is_none()) {
            all.into_iter().for_each(|solved| solved.errors = None);
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

    /// Whether the contacts are those of a runner that slides.
    pub fn is_sliding(&self) -> bool {
        self.nodes[0].sliding.is_some()
    }

    /// The quantities that the table holds, in the order files list them.
    pub fn quantities(&self) -> &'static [Quantity] {
        Quantity::of(self.is_sliding())
    }

    /// What an interpolation error is asked of: the coefficient of friction or, at rest, the peak pressure.
    pub fn judged(&self) -> Quantity {
        Quantity::judged(self.is_sliding())
    }

    /// How many nodes and checks a method solved.
    pub fn solved_by(&self, method: Method) -> usize {
        let checks = self.checks.iter().map(|check| &check.solved);
        let all = self.nodes.iter().chain(checks);
        all.filter(|solved| solved.method == method).count()
    }

    /// Keys of the figures of every node and check.
    pub fn keys(&self) -> Vec<&'static str> {
        self.nodes[0].own_keys()
    }

    /// Largest estimated solver error of a quantity over the nodes, relative; `None` where it is not kept.
    pub fn solver_error_of(&self, quantity: Quantity) -> Option<f64> {
        let relative = |node: &Solved| Some((node.error(quantity)? / node.get(quantity)?).abs());
        let all: Option<Vec<f64>> = self.nodes.iter().map(relative).collect();
        Some(all?.into_iter().fold(0.0, f64::max))
    }

    /// Largest estimated solver error over the nodes, relative, of what is [judged](Self::judged).
    pub fn solver_error(&self) -> f64 {
        let errors = self.nodes.iter().map(Solved::relative_error);
        errors.fold(0.0, f64::max)
    }
}

pub(crate) fn finite(point: &Point, solved: &Solved) -> Result<(), Error> {
    for (value, key) in solved.figures().into_iter().zip(solved.own_keys()) {
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
