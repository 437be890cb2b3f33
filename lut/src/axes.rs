//! The axes of a table: their breakpoints, and the points that they span.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::reduced::CurvatureScaling;

/// Largest number of breakpoints of an axis.
pub const MAX_AXIS: usize = 4096;
/// Largest number of nodes of a table.
pub const MAX_NODES: usize = 1 << 20;
/// Number of kinds of axes.
pub(crate) const KINDS: usize = 5;

/// A kind of axis. The order of the kinds is that of the nodes, the last one fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AxisKind {
    /// Normal force [N].
    Fz,
    /// Track curvature in the vertical plane, positive in a valley [1/m].
    Curvature,
    /// Rocker radius of the runner [m].
    RockerRadius,
    /// Speed of a sliding runner [m/s].
    Speed,
    /// Temperature of the ice under a sliding runner [C].
    IceTemperature,
}

impl AxisKind {
    /// All kinds.
    pub const ALL: [AxisKind; KINDS] = [
        AxisKind::Fz,
        AxisKind::Curvature,
        AxisKind::RockerRadius,
        AxisKind::Speed,
        AxisKind::IceTemperature,
    ];

    /// Key with its unit.
    pub fn key(self) -> &'static str {
        ["fz_n", "curvature_1pm", "rocker_radius_m", "v_mps", "ice_c"][self as usize]
    }

    /// Unit.
    pub fn unit(self) -> &'static str {
        ["N", "1/m", "m", "m/s", "C"][self as usize]
    }

    /// Whether its values are positive, and subdivided and interpolated on a logarithmic scale.
    pub(crate) fn is_logarithmic(self) -> bool {
        !matches!(self, AxisKind::Curvature | AxisKind::IceTemperature)
    }

    /// The coordinate of the smooth interpolation: the logarithm of the value, or the value.
    #[inline]
    pub(crate) fn scaled(self, value: f64) -> f64 {
        if self.is_logarithmic() {
            value.ln()
        } else {
            value
        }
    }

    /// Whether only a sliding runner has it.
    pub(crate) fn is_sliding(self) -> bool {
        matches!(self, AxisKind::Speed | AxisKind::IceTemperature)
    }
}

/// Rule for an input outside an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outside {
    /// The nearest end of the axis replaces the input.
    #[default]
    Hold,
    /// Linear extrapolation, in the coordinates of the interpolation mode.
    Linear,
    /// The value is NaN.
    Error,
}

impl Outside {
    /// All rules.
    pub const ALL: [Outside; 3] = [Outside::Hold, Outside::Linear, Outside::Error];

    /// Name in files.
    pub fn name(self) -> &'static str {
        ["hold", "linear", "error"][self as usize]
    }

    /// Whether it is the default, which files omit.
    pub(crate) fn is_hold(&self) -> bool {
        *self == Outside::Hold
    }
}

/// Coordinates at which a contact is solved or a table evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Normal force [N].
    pub fz: f64,
    /// Track curvature in the vertical plane, positive in a valley [1/m].
    pub curvature: f64,
    /// Rocker radius of the runner, for a table with this axis [m].
    pub rocker_radius: Option<f64>,
    /// Speed, for a table with this axis [m/s].
    pub speed: Option<f64>,
    /// Temperature of the ice, for a table with this axis [C].
    pub ice_c: Option<f64>,
}

impl Point {
    /// A force [N] and a curvature [1/m], without further coordinates.
    #[inline]
    pub fn at_rest(fz: f64, curvature: f64) -> Self {
        Point {
            fz,
            curvature,
            ..Point::default()
        }
    }

    /// A force [N], a curvature [1/m], a speed [m/s] and a temperature of the ice [C].
    #[inline]
    pub fn sliding(fz: f64, curvature: f64, speed: f64, ice_c: f64) -> Self {
        Point {
            speed: Some(speed),
            ice_c: Some(ice_c),
            ..Point::at_rest(fz, curvature)
        }
    }

    /// The coordinate along an axis; `None` if the point does not have it.
    #[inline]
    pub fn get(&self, kind: AxisKind) -> Option<f64> {
        match kind {
            AxisKind::Fz => Some(self.fz),
            AxisKind::Curvature => Some(self.curvature),
            AxisKind::RockerRadius => self.rocker_radius,
            AxisKind::Speed => self.speed,
            AxisKind::IceTemperature => self.ice_c,
        }
    }

    /// Sets the coordinate along an axis.
    #[must_use]
    pub fn with(mut self, kind: AxisKind, value: f64) -> Self {
        match kind {
            AxisKind::Fz => self.fz = value,
            AxisKind::Curvature => self.curvature = value,
            AxisKind::RockerRadius => self.rocker_radius = Some(value),
            AxisKind::Speed => self.speed = Some(value),
            AxisKind::IceTemperature => self.ice_c = Some(value),
        }
        self
    }

    /// Keys and coordinates, in the order of the axes.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let kinds = AxisKind::ALL.into_iter();
        kinds.filter_map(|kind| Some((kind.key(), self.get(kind)?)))
    }
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (n, (key, value)) in self.named().enumerate() {
            let comma = if n == 0 { "" } else { ", " };
            write!(f, "{comma}{key} = {value}")?;
        }
        Ok(())
    }
}

/// Breakpoints, strictly increasing on every axis.
///
/// A table has an axis of forces, one of curvatures, and any of the other kinds. Nodes are numbered
/// with the last axis fastest.
///
/// ```
/// use kufe_lut::{Axes, AxisKind};
/// let axes = Axes::new(vec![500.0, 2000.0], vec![0.0, 0.02])?
///     .with(AxisKind::Speed, vec![5.0, 15.0, 40.0])?;
/// assert_eq!(axes.node_count(), 12);
/// assert_eq!(axes.points()[1].speed, Some(15.0));
/// # Ok::<(), kufe_lut::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axes {
    /// Breakpoints by kind.
    values: [Option<Vec<f64>>; KINDS],
    /// Rules for inputs outside, by kind.
    outside: [Outside; KINDS],
    /// Parameters of the reduced curvatures, if the second axis has them.
    flush: Option<CurvatureScaling>,
}

impl Axes {
    /// Axes of forces [N] and curvatures [1/m].
    ///
    /// # Errors
    /// As [`with`](Self::with).
    pub fn new(fz: Vec<f64>, curvature: Vec<f64>) -> Result<Self, Error> {
        let axes = Axes::default().with(AxisKind::Fz, fz)?;
        axes.with(AxisKind::Curvature, curvature)
    }

    /// Axes of forces [N] and reduced curvatures between 0 and 1.
    ///
    /// # Errors
    /// As [`with`](Self::with); [`Error::Axis`] where a reduced curvature is not between 0
    /// and 1.
    pub fn reduced(
        fz: Vec<f64>,
        reduced: Vec<f64>,
        flush: CurvatureScaling,
    ) -> Result<Self, Error> {
        let axes = Axes::default().with(AxisKind::Fz, fz)?;
        axes.with_reduced(reduced, flush)
    }

    /// Sets reduced curvatures as the second axis.
    pub(crate) fn with_reduced(
        self,
        reduced: Vec<f64>,
        flush: CurvatureScaling,
    ) -> Result<Self, Error> {
        if let Some(index) = reduced.iter().position(|t| !(0.0..=1.0).contains(t)) {
            let (axis, expected) = ("reduced_curvature", "a number between 0 and 1");
            return Err(Error::axis_value(axis, index, reduced[index], expected));
        }
        let mut axes = self.with(AxisKind::Curvature, reduced)?;
        axes.flush = Some(flush);
        Ok(axes)
    }

    /// Sets the breakpoints along an axis.
    ///
    /// # Errors
    /// [`Error::Axis`] if the axis is empty or too long, or if a value is not finite, not above the
    /// one before, or not positive on an axis other than curvature and temperature;
    /// [`Error::Invalid`] for more than [`MAX_NODES`] nodes, and with reduced curvatures.
    pub fn with(mut self, kind: AxisKind, values: Vec<f64>) -> Result<Self, Error> {
        if self.flush.is_some() {
            return Err(Error::flush_plan());
        }
        check(kind, &values)?;
        self.values[kind as usize] = Some(values);
        let found = self.shape().into_iter().fold(1, usize::saturating_mul);
        if found > MAX_NODES {
            return Err(Error::Invalid(format!(
                "the axes span {found} nodes: expected at most {MAX_NODES}"
            )));
        }
        Ok(self)
    }

    /// Sets the rule for inputs outside an axis. A rocker radius outside is always an error.
    #[must_use]
    pub fn with_outside(mut self, kind: AxisKind, rule: Outside) -> Self {
        self.outside[kind as usize] = rule;
        self
    }

    /// Rule for inputs outside an axis.
    pub fn outside(&self, kind: AxisKind) -> Outside {
        self.outside[kind as usize]
    }

    /// Breakpoints along an axis; `None` if the table does not have it.
    pub fn get(&self, kind: AxisKind) -> Option<&[f64]> {
        self.values[kind as usize].as_deref()
    }

    /// Normal forces [N].
    pub fn fz(&self) -> &[f64] {
        self.get(AxisKind::Fz).unwrap_or_default()
    }

    /// Track curvatures, positive in a valley [1/m], or reduced curvatures from 0 to 1 if
    /// [`Axes::flush`] is `Some`.
    pub fn curvature(&self) -> &[f64] {
        self.get(AxisKind::Curvature).unwrap_or_default()
    }

    /// Parameters of the reduced curvatures, if the second axis has them.
    pub fn flush(&self) -> Option<&CurvatureScaling> {
        self.flush.as_ref()
    }

    /// The track curvature [1/m] at a force [N] and a coordinate of the second axis.
    pub fn curvature_at(&self, fz: f64, place: f64) -> f64 {
        self.flush.map_or(place, |flush| flush.curvature(fz, place))
    }

    /// Smallest and largest value along an axis, where the table has it; of the second axis the
    /// track curvatures at a force [N].
    pub fn range(&self, kind: AxisKind, fz: f64) -> Option<[f64; 2]> {
        let values = self.get(kind)?;
        let ends = [values[0], values[values.len() - 1]];
        Some(match kind {
            AxisKind::Curvature => ends.map(|place| self.curvature_at(fz, place)),
            _ => ends,
        })
    }

    /// Rocker radii where the table has that axis [m].
    pub fn rocker_radius(&self) -> Option<&[f64]> {
        self.get(AxisKind::RockerRadius)
    }

    /// Speeds [m/s]; `None` if the table does not have this axis.
    pub fn speed(&self) -> Option<&[f64]> {
        self.get(AxisKind::Speed)
    }

    /// Temperatures of the ice [C]; `None` if the table does not have this axis.
    pub fn ice_c(&self) -> Option<&[f64]> {
        self.get(AxisKind::IceTemperature)
    }

    /// Whether there is an axis that only a sliding runner has.
    pub fn is_sliding(&self) -> bool {
        self.present().any(|(kind, _)| kind.is_sliding())
    }

    /// The axes of the table, in the order of the nodes.
    pub(crate) fn present(&self) -> impl DoubleEndedIterator<Item = (AxisKind, &[f64])> {
        let kinds = AxisKind::ALL.into_iter();
        kinds.filter_map(|kind| Some((kind, self.get(kind)?)))
    }

    /// Name, unit and breakpoints of every axis, in the order of the nodes.
    pub fn named(&self) -> Vec<(&'static str, &'static str, &[f64])> {
        let named = self.present().map(|(kind, values)| match kind {
            AxisKind::Curvature if self.flush.is_some() => ("reduced_curvature", "1", values),
            _ => (kind.key(), kind.unit(), values),
        });
        named.collect()
    }

    /// Number of breakpoints along every axis.
    pub fn shape(&self) -> Vec<usize> {
        self.present().map(|(_, values)| values.len()).collect()
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.shape().iter().product()
    }

    /// Number of nodes at one force and curvature.
    pub fn layers(&self) -> usize {
        self.shape()[2..].iter().product()
    }

    /// Index of the node at breakpoints `i` (force) and `j` (curvature), and at `k` among the nodes
    /// of one force and curvature.
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (i * self.curvature().len() + j) * self.layers() + k
    }

    /// The point of a node.
    fn point(&self, node: usize) -> Point {
        let (mut point, mut rest) = (Point::default(), node);
        for (kind, values) in self.present().rev() {
            point = point.with(kind, values[rest % values.len()]);
            rest /= values.len();
        }
        point.curvature = self.curvature_at(point.fz, point.curvature);
        point
    }

    /// The points of all nodes in their order.
    pub fn points(&self) -> Vec<Point> {
        let nodes = 0..self.node_count();
        nodes.map(|node| self.point(node)).collect()
    }

    /// The corners of the cell that contains a point; a corner may occur more than once.
    pub(crate) fn around(&self, point: &Point) -> Vec<usize> {
        let mut corners = vec![0];
        for (kind, values) in self.present() {
            let value = match (kind, &self.flush) {
                (AxisKind::Curvature, Some(flush)) => flush.reduced(point.fz, point.curvature),
                _ => point.get(kind).unwrap_or(values[0]),
            };
            let high = values.partition_point(|&v| v < value).min(values.len() - 1);
            let ends = [high.saturating_sub(1), high];
            let wider = corners
                .iter()
                .flat_map(|n| ends.map(|end| n * values.len() + end));
            corners = wider.collect();
        }
        corners
    }
}

fn check(kind: AxisKind, values: &[f64]) -> Result<(), Error> {
    let axis = kind.key();
    if values.is_empty() || values.len() > MAX_AXIS {
        let problem = format!(" has {} values: expected 1 to {MAX_AXIS}", values.len());
        return Err(Error::Axis { axis, problem });
    }
    for (index, &value) in values.iter().enumerate() {
        let expected = if !value.is_finite() {
            "a finite number"
        } else if kind.is_logarithmic() && value <= 0.0 {
            "a positive number"
        } else if index > 0 && value <= values[index - 1] {
            "a value above the one before"
        } else {
            continue;
        };
        return Err(Error::axis_value(axis, index, value, expected));
    }
    Ok(())
}
