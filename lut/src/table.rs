//! A table: axes, the figures at its nodes, the checks between them, and its origin.

use serde::{Deserialize, Serialize};

use crate::axes::{Axes, AxisKind, Outside, Point};
use crate::error::Error;
use crate::interpolator::{Interpolator, Mode};
use crate::quantity::{Figures, Method, Quantity};
use crate::solve::Solve;

/// Origin of the results of a table: the version of the program and the case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "OriginKeys")]
pub struct Origin {
    version: String,
    case_sha256: String,
}

/// The keys of an origin, before checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OriginKeys {
    version: String,
    case_sha256: String,
}

impl TryFrom<OriginKeys> for Origin {
    type Error = Error;

    fn try_from(keys: OriginKeys) -> Result<Self, Error> {
        Origin::new(keys.version, keys.case_sha256)
    }
}

impl Origin {
    /// The `version` of the program that solves, and the hexadecimal SHA-256 over the case, the
    /// content of its files and the solver's tolerance.
    ///
    /// # Errors
    /// [`Error::Format`] where the version is not 1 to 40 letters, digits, dots, plus or minus
    /// signs, or where the hash is not 64 hexadecimal digits.
    pub fn new(version: String, case_sha256: String) -> Result<Self, Error> {
        let plain = |c: u8| c.is_ascii_alphanumeric() || b".+-".contains(&c);
        if version.is_empty() || version.len() > 40 || !version.bytes().all(plain) {
            let expected = "1 to 40 of the characters 0-9 A-Z a-z . + -";
            return Err(Error::format("version", &version, expected));
        }
        if case_sha256.len() != 64 || !case_sha256.bytes().all(|c| c.is_ascii_hexdigit()) {
            let expected = "64 hexadecimal digits";
            return Err(Error::format("case_sha256", &case_sha256, expected));
        }
        Ok(Origin {
            version,
            case_sha256,
        })
    }

    /// Version of the program that solved the contacts.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// SHA-256 of the case, hexadecimal.
    pub fn case_sha256(&self) -> &str {
        &self.case_sha256
    }
}

impl Default for Origin {
    /// The version of this crate, and a hash of zeros for a table without a case.
    fn default() -> Self {
        Origin {
            version: env!("CARGO_PKG_VERSION").into(),
            case_sha256: "0".repeat(64),
        }
    }
}

/// Contact figures as functions of normal force, track curvature and further axes, with their
/// errors and origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    axes: Axes,
    /// Figures in the order of the nodes. If one node or check has no error of a quantity, no
    /// node has one.
    nodes: Vec<Figures>,
    checks: Vec<Solve>,
    /// Requested relative interpolation error of the [judged](Self::judged) quantity; `None`
    /// without a request.
    pub interpolation_requested: Option<f64>,
    /// The case as JSON; its load and track are replaced by the axes.
    pub case: String,
    /// The program and the case of the figures.
    pub origin: Origin,
}

/// Interpolation error of one quantity in one mode, measured at [`Table::checks`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterpolationError {
    /// Largest error relative to the solved value.
    pub max: f64,
    /// Root of the mean square of the relative errors.
    pub rms: f64,
    /// The point of the largest error.
    pub max_at: Point,
}

impl Table {
    /// A table from the figures at its nodes, in the order of [`Axes::points`], and solves between
    /// them.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `nodes` does not fit `axes`, if a figure of a node or a check is not
    /// finite, or if some points are sliding and others at rest.
    pub fn new(axes: Axes, nodes: &[Figures], checks: Vec<Solve>) -> Result<Self, Error> {
        if nodes.len() != axes.node_count() {
            return Err(Error::node_count(nodes.len(), axes.node_count()));
        }
        let sliding = axes.is_sliding() || nodes[0].is_sliding();
        let at_nodes = axes.points().into_iter().zip(nodes);
        let at_checks = checks.iter().map(|check| (check.point, &check.figures));
        for (point, figures) in at_nodes.chain(at_checks) {
            check_finite(&point, figures)?;
            if figures.is_sliding() != sliding {
                return Err(Error::sliding_mixture(&point));
            }
        }
        let mut nodes = nodes.to_vec();
        for &quantity in Quantity::of(sliding) {
            let at_checks = checks.iter().map(|check| &check.figures);
            let mut all = nodes.iter().chain(at_checks);
            if all.any(|figures| figures.error(quantity).is_none()) {
                let without = nodes.iter().map(|node| node.with_error(quantity, f64::NAN));
                nodes = without.collect();
            }
        }
        Ok(Table {
            axes,
            nodes,
            checks,
            interpolation_requested: None,
            case: "null".into(),
            origin: Origin::default(),
        })
    }

    /// Breakpoints.
    pub fn axes(&self) -> &Axes {
        &self.axes
    }

    /// Sets the rule for inputs outside an axis.
    #[must_use]
    pub fn with_outside(mut self, kind: AxisKind, rule: Outside) -> Self {
        self.axes = self.axes.with_outside(kind, rule);
        self
    }

    /// Solves between the nodes, which measure the interpolation error.
    pub fn checks(&self) -> &[Solve] {
        &self.checks
    }

    /// A quantity at the nodes, in the order of [`Axes::points`]; `None` for a quantity of sliding
    /// in a table at rest.
    pub fn values(&self, quantity: Quantity) -> Option<Vec<f64>> {
        self.nodes.iter().map(|node| node.get(quantity)).collect()
    }

    /// Estimated solver errors of a quantity at the nodes; `None` if unknown.
    pub fn errors(&self, quantity: Quantity) -> Option<Vec<f64>> {
        self.nodes.iter().map(|node| node.error(quantity)).collect()
    }

    /// The figures at the nodes, in the order of [`Axes::points`].
    pub fn nodes(&self) -> &[Figures] {
        &self.nodes
    }

    /// Nodes and checks with their points.
    pub fn solves(&self) -> impl Iterator<Item = Solve> {
        let points = self.axes.points().into_iter();
        let nodes = points.zip(&self.nodes);
        let nodes = nodes.map(|(point, &figures)| Solve { point, figures });
        nodes.chain(self.checks.iter().copied())
    }

    /// Whether the contacts are those of a sliding runner.
    pub fn is_sliding(&self) -> bool {
        self.nodes[0].is_sliding()
    }

    /// The quantities of the table, in the order of the files.
    pub fn quantities(&self) -> &'static [Quantity] {
        Quantity::of(self.is_sliding())
    }

    /// The quantity that a tolerance applies to: the coefficient of friction or, at rest, the peak
    /// pressure.
    pub fn judged(&self) -> Quantity {
        Quantity::judged(self.is_sliding())
    }

    /// Number of nodes and checks that a method solved.
    pub fn solved_by(&self, method: Method) -> usize {
        let checks = self.checks.iter().map(|check| &check.figures);
        let all = self.nodes.iter().chain(checks);
        all.filter(|figures| figures.method == method).count()
    }

    /// Largest estimated solver error of a quantity over the nodes, relative; `None` if unknown.
    pub fn solver_error_of(&self, quantity: Quantity) -> Option<f64> {
        let errors = self.errors(quantity)?.into_iter();
        let pairs = errors.zip(self.values(quantity)?);
        Some(pairs.fold(0.0, |most, (error, value)| (error / value).abs().max(most)))
    }

    /// Largest estimated solver error of the [judged](Self::judged) quantity over the nodes,
    /// relative.
    pub fn solver_error(&self) -> f64 {
        self.solver_error_of(self.judged()).unwrap_or(f64::NAN)
    }

    /// Relative interpolation error at every check; `None` where a contact does not have the quantity.
    ///
    /// # Errors
    /// As [`Interpolator::new`].
    pub fn check_errors(&self, quantity: Quantity, mode: Mode) -> Result<Vec<Option<f64>>, Error> {
        let mut current: Option<(Option<f64>, Interpolator)> = None;
        let error = |check: &Solve| {
            let radius = check.point.rocker_radius;
            if current.as_ref().is_none_or(|(at, _)| *at != radius) {
                current = Some((radius, Interpolator::new(self, quantity, mode, radius)?));
            }
            let interpolator = current.as_ref().map(|(_, interpolator)| interpolator);
            Ok(interpolator.and_then(|at| relative_error(at, check, quantity)))
        };
        self.checks.iter().map(error).collect()
    }

    /// Interpolation error measured at the checks; `None` without checks.
    ///
    /// # Errors
    /// As [`Interpolator::new`].
    pub fn interpolation_error(
        &self,
        quantity: Quantity,
        mode: Mode,
    ) -> Result<Option<InterpolationError>, Error> {
        let errors = self.check_errors(quantity, mode)?;
        let known = self.checks.iter().zip(errors);
        let known = known.filter_map(|(check, error)| Some((error?, check.point)));
        let known: Vec<(f64, Point)> = known.collect();
        let square = known.iter().map(|(error, _)| error * error).sum::<f64>();
        let rms = (square / self.checks.len() as f64).sqrt();
        let larger = |worst: (f64, Point), other: (f64, Point)| {
            if other.0 > worst.0 { other } else { worst }
        };
        let worst = known.into_iter().reduce(larger);
        Ok(worst.map(|(max, max_at)| InterpolationError { max, rms, max_at }))
    }
}

/// Error of an interpolated value relative to the solved value, or the absolute error if the solved
/// value is 0; `None` if the contact does not have the quantity.
pub(crate) fn relative_error(
    interpolator: &Interpolator,
    check: &Solve,
    quantity: Quantity,
) -> Option<f64> {
    let truth = check.figures.get(quantity)?;
    let value = interpolator.at(check.point).value;
    let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
    Some((value - truth).abs() / scale)
}

/// Checks that the figures of a point are complete and finite.
///
/// # Errors
/// [`Error::Invalid`] with the first figure that is missing or not finite.
pub fn check_finite(point: &Point, figures: &Figures) -> Result<(), Error> {
    match figures.not_finite() {
        None => Ok(()),
        Some((quantity, value)) => Err(Error::Invalid(format!(
            "{quantity} at {point} = {value}: expected a finite number"
        ))),
    }
}
