//! Documents of lookup tables: contents of a table, and its values at one contact.

use kufe_lut::{
    Axes, AxisKind, Error, Interpolator, Method, Mode, Outside, Point, Quantity, Table,
};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::plot::extent;

/// Largest relative error of an interpolation; `None` if it was not measured.
fn error(table: &Table, quantity: Quantity, mode: Mode) -> Result<Option<f64>, Error> {
    let measured = table.interpolation_error(quantity, mode)?;
    Ok(measured.map(|measured| measured.max))
}

/// A computed table with the cost of its solution.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TableSummary {
    /// Nodes.
    pub nodes: usize,
    /// Breakpoints of the force.
    pub fz_values: usize,
    /// Breakpoints of the curvature.
    pub curvature_values: usize,
    /// Breakpoints of the rocker radius, if it is an axis.
    pub rocker_radius_values: Option<usize>,
    /// Breakpoints of the speed, if it is an axis.
    pub v_values: Option<usize>,
    /// Breakpoints of the temperature of the ice, if it is an axis.
    pub ice_values: Option<usize>,
    /// Points between the nodes at which the interpolation was measured.
    pub checks: usize,
    /// Solutions by boundary elements.
    pub by_boundary_elements: usize,
    /// Requested relative error of the interpolation.
    pub interpolation_requested: Option<f64>,
    /// Largest measured relative error of smooth interpolation.
    pub interpolation_smooth: Option<f64>,
    /// Largest measured relative error of bilinear interpolation.
    pub interpolation_bilinear: Option<f64>,
    /// Largest estimated relative error of the solver's peak pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_p_max: Option<f64>,
    /// Largest estimated relative error of the solver's coefficient of friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_mu: Option<f64>,
    /// Contacts solved.
    pub solves: usize,
    /// Wall time [s].
    pub seconds: f64,
    /// Version of kufe.
    pub version: String,
}

impl TableSummary {
    /// Summary of a table for which `solves` contacts were solved in `seconds` [s].
    ///
    /// # Errors
    /// Those of the interpolation at the checks.
    pub fn new(table: &Table, solves: usize, seconds: f64) -> Result<Self, Error> {
        let axes = table.axes();
        let solver = |of| (table.judged() == of).then(|| table.solver_error());
        Ok(TableSummary {
            nodes: axes.node_count(),
            fz_values: axes.fz().len(),
            curvature_values: axes.curvature().len(),
            rocker_radius_values: axes.rocker_radius().map(<[f64]>::len),
            v_values: axes.speed().map(<[f64]>::len),
            ice_values: axes.ice_c().map(<[f64]>::len),
            checks: table.checks().len(),
            by_boundary_elements: table.solved_by(Method::BoundaryElements),
            interpolation_requested: table.interpolation_requested,
            interpolation_smooth: error(table, table.judged(), Mode::Smooth)?,
            interpolation_bilinear: error(table, table.judged(), Mode::Bilinear)?,
            solver_p_max: solver(Quantity::PMax),
            solver_mu: solver(Quantity::Mu),
            solves,
            seconds,
            version: table.origin.version().to_owned(),
        })
    }
}

/// The axes, quantities and errors of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TableInfo {
    /// "lookup table".
    pub kind: &'static str,
    /// The command that writes it.
    pub written_by: &'static str,
    /// The axes by key.
    #[serde(serialize_with = "in_order")]
    pub axes: Vec<(&'static str, AxisRange)>,
    /// The quantities by key.
    #[serde(serialize_with = "in_order")]
    pub quantities: Vec<(&'static str, QuantityRange)>,
    /// Nodes.
    pub nodes: usize,
    /// Points between the nodes at which the interpolation was measured.
    pub checks: usize,
    /// Solutions by boundary elements.
    pub by_boundary_elements: usize,
    /// Largest estimated relative error of the solver's peak pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_error_p_max: Option<f64>,
    /// Largest estimated relative error of the solver's coefficient of friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_error_mu: Option<f64>,
    /// Requested relative error of the interpolation.
    pub interpolation_requested: Option<f64>,
    /// SHA-256 of the case and its files.
    pub case_sha256: String,
    /// Version of kufe that made the table.
    pub version: String,
    /// Platforms of an FMU.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub platforms: Option<String>,
}

/// The extent of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisRange {
    /// Number of breakpoints.
    pub points: usize,
    /// The first breakpoint.
    pub from: f64,
    /// The last breakpoint.
    pub to: f64,
    /// Rule for inputs outside: "hold", "linear" or "error".
    pub outside: &'static str,
}

impl AxisRange {
    /// The axes of a table by key.
    pub(crate) fn of(axes: &Axes) -> impl Iterator<Item = (&'static str, AxisRange)> {
        AxisKind::ALL.into_iter().filter_map(|kind| {
            let [from, to] = axes.range(kind, axes.fz()[0])?;
            let outside = match kind {
                // A rocker radius outside is refused.
                AxisKind::RockerRadius => Outside::Error,
                _ => axes.outside(kind),
            };
            let range = AxisRange {
                points: axes.get(kind)?.len(),
                from,
                to,
                outside: outside.name(),
            };
            Some((kind.key(), range))
        })
    }
}

/// The range of a quantity, and its largest relative errors of interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct QuantityRange {
    /// Smallest value at a node.
    pub min: f64,
    /// Largest value at a node.
    pub max: f64,
    /// Error of smooth interpolation; `None` if it was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth_error: Option<f64>,
    /// Error of bilinear interpolation; `None` if it was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bilinear_error: Option<f64>,
}

fn in_order<T: Serialize, S: Serializer>(
    entries: &[(&'static str, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(entries.iter().map(|(key, value)| (key, value)))
}

impl TableInfo {
    /// Contents of a table; `platforms` are those of the FMU that contains it.
    ///
    /// # Errors
    /// Those of the interpolation at the checks.
    pub fn new(table: &Table, platforms: Option<String>) -> Result<Self, Error> {
        let axes = table.axes();
        let ranges = AxisRange::of(axes).collect();
        let mut quantities = Vec::new();
        for &quantity in table.quantities() {
            let values = table.values(quantity).unwrap_or_default();
            let [min, max] = extent(values.iter().copied());
            let range = QuantityRange {
                min,
                max,
                smooth_error: error(table, quantity, Mode::Smooth)?,
                bilinear_error: error(table, quantity, Mode::Bilinear)?,
            };
            quantities.push((quantity.key(), range));
        }
        let solver = |of| (table.judged() == of).then(|| table.solver_error());
        Ok(TableInfo {
            kind: "lookup table",
            written_by: "kufe lut",
            axes: ranges,
            quantities,
            nodes: axes.node_count(),
            checks: table.checks().len(),
            by_boundary_elements: table.solved_by(Method::BoundaryElements),
            solver_error_p_max: solver(Quantity::PMax),
            solver_error_mu: solver(Quantity::Mu),
            interpolation_requested: table.interpolation_requested,
            case_sha256: table.origin.case_sha256().to_owned(),
            version: table.origin.version().to_owned(),
            platforms,
        })
    }
}

/// The values of a table at one contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TableLookup {
    /// The quantities with their errors.
    #[serde(flatten, serialize_with = "by_key")]
    pub values: Vec<LookupValue>,
    /// Normal force [N].
    pub fz_n: f64,
    /// Curvature of the track [1/m].
    pub curvature_1pm: f64,
    /// Speed, if it is an axis [m/s].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub v_mps: Option<f64>,
    /// Temperature of the ice, if it is an axis [deg C].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ice_c: Option<f64>,
    /// The interpolation.
    pub mode: &'static str,
    /// Whether the point is outside the table; the values then follow the rules of its axes.
    pub out_of_range: bool,
    /// Version of kufe that made the table.
    pub version: String,
}

/// The value of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookupValue {
    /// The quantity.
    pub quantity: Quantity,
    /// Its value, in SI units.
    pub value: f64,
    /// Sum of the largest errors of interpolation and solver at this value; `None` where neither is
    /// known.
    pub error: Option<f64>,
    /// Whether the error includes that of the solver; else it is that of the interpolation alone.
    pub includes_solver: bool,
}

fn by_key<S: Serializer>(values: &[LookupValue], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(None)?;
    for value in values {
        map.serialize_entry(value.quantity.key(), &value.value)?;
        let mut key = value.quantity.error_key().to_owned();
        if !value.includes_solver {
            key = key.replacen("_error", "_interpolation_error", 1);
        }
        map.serialize_entry(&key, &value.error)?;
    }
    map.end()
}

/// Relative error of interpolated values: the sum of the largest errors of interpolation and solver;
/// `None` where neither is known.
///
/// # Errors
/// Those of the interpolation at the checks.
pub fn lookup_error(table: &Table, quantity: Quantity, mode: Mode) -> Result<Option<f64>, Error> {
    let measured = error(table, quantity, mode)?;
    let solver = table.solver_error_of(quantity);
    Ok(solver.map_or(measured, |s| Some(s + measured.unwrap_or(0.0))))
}

impl TableLookup {
    /// Interpolates every quantity of a table.
    ///
    /// # Errors
    /// Those of the interpolation.
    pub fn new(table: &Table, at: Point, mode: Mode) -> Result<Self, Error> {
        let (mut values, mut out_of_range) = (Vec::new(), false);
        for &quantity in table.quantities() {
            let interpolator = Interpolator::new(table, quantity, mode, at.rocker_radius)?;
            let found = interpolator.at(at);
            out_of_range |= found.out_of_range;
            let relative = lookup_error(table, quantity, mode)?;
            values.push(LookupValue {
                quantity,
                value: found.value,
                error: relative.map(|relative| (relative * found.value).abs()),
                includes_solver: table.solver_error_of(quantity).is_some(),
            });
        }
        let axes = table.axes();
        Ok(TableLookup {
            values,
            fz_n: at.fz,
            curvature_1pm: at.curvature,
            v_mps: axes.speed().and(at.speed),
            ice_c: axes.ice_c().and(at.ice_c),
            mode: mode.name(),
            out_of_range,
            version: table.origin.version().to_owned(),
        })
    }
}
