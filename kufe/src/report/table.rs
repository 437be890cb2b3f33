//! Data of the page of a lookup table.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use kufe_lut::{Axes, CurvatureScaling, Error, Method, Mode, Point, Quantity, Table};
use serde::Serialize;

use crate::plot::{Scale, shown_unit};
use crate::results::{AxisRange, CaseRecord, Description};

/// Largest numbers of forces, curvatures and layers (rocker radii, speeds, temperatures of the ice)
/// of the page; longer axes are thinned.
const MAX_SIZES: [usize; 3] = [60, 60, 30];

/// Largest number of checks of the page: those with the largest errors.
const MAX_CHECKS: usize = 300;

/// Data of the page of a table.
#[derive(Clone, Debug, Serialize)]
pub struct TablePage<'a> {
    name: &'a str,
    axes: Vec<AxisData>,
    fz: Vec<f64>,
    curvature: Vec<f64>,
    flush: Option<[f64; 4]>,
    /// Name of each layer.
    layers: Option<Vec<String>>,
    /// Names of the axes of the layers.
    layered: Option<String>,
    thinned: bool,
    nodes: usize,
    check_count: usize,
    /// The solves between the nodes with the largest errors.
    checks: Vec<CheckPlace>,
    by_boundary_elements: usize,
    quantities: Vec<QuantityData>,
    solver_error: f64,
    judged: &'static str,
    interpolation_requested: Option<f64>,
    case: CaseRecord,
    case_sha256: &'a str,
    version: &'a str,
}

/// A quantity of a table.
#[derive(Clone, Debug, Serialize)]
struct QuantityData {
    name: &'static str,
    label: &'static str,
    /// Display unit, and the number of display units in one SI unit.
    unit: String,
    times: f64,
    /// Largest measured error by mode.
    errors: BTreeMap<&'static str, Option<f64>>,
    /// Values by layer, force and curvature.
    values: Vec<Vec<Vec<f64>>>,
    /// Relative errors of the solver in the order of `values`, if they are known.
    solver: Option<Vec<Vec<Vec<f64>>>>,
    /// Relative error of smooth interpolation at the checks of the page.
    check_errors: Vec<Option<f64>>,
}

/// An axis of a table.
#[derive(Clone, Debug, Serialize)]
struct AxisData {
    name: &'static str,
    #[serde(flatten)]
    range: AxisRange,
}

/// Coordinates of a check.
#[derive(Clone, Debug, Serialize)]
struct CheckPlace {
    fz: f64,
    curvature: f64,
    /// The coordinates along the axes of layers.
    layer: String,
}

impl<'a> TablePage<'a> {
    /// The data of a table; `name` is its name on the page.
    ///
    /// # Errors
    /// Those of the interpolation at the checks.
    pub fn new(table: &'a Table, name: &'a str) -> Result<Self, Error> {
        let axes = table.axes();
        let taken = [
            thinned(axes.fz().len(), MAX_SIZES[0]),
            thinned(axes.curvature().len(), MAX_SIZES[1]),
            thinned(axes.layers(), MAX_SIZES[2]),
        ];
        let pick = |values: &[f64], which: &[usize]| which.iter().map(|&k| values[k]).collect();
        let (layered, layers) = layers(axes, &taken[2]).unzip();
        let judged = table.check_errors(table.judged(), Mode::Smooth)?;
        let mut worst: Vec<usize> = (0..judged.len()).collect();
        worst.sort_by(|&a, &b| judged[b].partial_cmp(&judged[a]).unwrap_or(Ordering::Equal));
        worst.truncate(MAX_CHECKS);
        let checks = worst.iter().map(|&k| table.checks()[k].point);
        let checks = checks.map(|point| CheckPlace {
            fz: point.fz,
            curvature: point.curvature,
            layer: layer_name(&point),
        });
        let quantity = |&quantity: &Quantity| {
            let at_checks = table.check_errors(quantity, Mode::Smooth)?;
            let mut errors = BTreeMap::new();
            for mode in Mode::ALL {
                let measured = table.interpolation_error(quantity, mode)?;
                errors.insert(mode.name(), measured.map(|m| m.max));
            }
            let values = table.values(quantity).unwrap_or_default();
            let relative = |errors: &[f64], node: usize| (errors[node] / values[node]).abs();
            let solver = table.errors(quantity);
            let solver = solver.map(|errors| cube(axes, &taken, |node| relative(&errors, node)));
            let unit = shown_unit(quantity.key());
            let Scale { unit, times } = Scale::of_all(&unit, values.iter().copied());
            Ok(QuantityData {
                name: quantity.name(),
                label: Description::of(quantity).label,
                unit,
                times,
                errors,
                values: cube(axes, &taken, |node| values[node]),
                solver,
                check_errors: worst.iter().map(|&k| at_checks[k]).collect(),
            })
        };
        let quantities = table.quantities().iter().map(quantity);
        let case: CaseRecord = serde_json::from_str(&table.case).unwrap_or_default();
        let ranges = AxisRange::of(axes);
        Ok(TablePage {
            name,
            axes: ranges
                .map(|(name, range)| AxisData { name, range })
                .collect(),
            fz: pick(axes.fz(), &taken[0]),
            curvature: pick(axes.curvature(), &taken[1]),
            flush: axes.flush().map(CurvatureScaling::numbers),
            layers,
            layered,
            thinned: axes.node_count() > taken.iter().map(Vec::len).product(),
            nodes: axes.node_count(),
            check_count: table.checks().len(),
            checks: checks.collect(),
            by_boundary_elements: table.solved_by(Method::BoundaryElements),
            quantities: quantities.collect::<Result<_, Error>>()?,
            solver_error: table.solver_error(),
            judged: table.judged().name(),
            interpolation_requested: table.interpolation_requested,
            case: case.effective(),
            case_sha256: table.origin.case_sha256(),
            version: table.origin.version(),
        })
    }
}

/// Names of the axes other than force and curvature, and the name of each selected combination of
/// their coordinates.
fn layers(axes: &Axes, taken: &[usize]) -> Option<(String, Vec<String>)> {
    let titles = [
        ("rocker radius", axes.rocker_radius()),
        ("speed", axes.speed()),
        ("ice", axes.ice_c()),
    ];
    let titles = titles.into_iter().filter(|(_, axis)| axis.is_some());
    let titles: Vec<&str> = titles.map(|(title, _)| title).collect();
    let points = axes.points();
    let names = taken.iter().map(|&k| layer_name(&points[k])).collect();
    (!titles.is_empty()).then(|| (titles.join(", "), names))
}

/// The coordinates of a point along the axes of layers, to four digits.
fn layer_name(point: &Point) -> String {
    let rounded = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
    let [radius, speed, ice] = [point.rocker_radius, point.speed, point.ice_c];
    let values = [(radius, "m"), (speed, "m/s"), (ice, "°C")].into_iter();
    let texts = values.filter_map(|(value, unit)| Some(format!("{} {unit}", rounded(value?))));
    texts.collect::<Vec<_>>().join(", ")
}

/// A number of every node that is taken, by layer, force and curvature.
fn cube(axes: &Axes, taken: &[Vec<usize>; 3], of: impl Fn(usize) -> f64) -> Vec<Vec<Vec<f64>>> {
    let [forces, curvatures, layers] = taken;
    let row = |i, k| curvatures.iter().map(|&j| of(axes.node(i, j, k))).collect();
    let layer = |&k: &usize| forces.iter().map(|&i| row(i, k)).collect();
    layers.iter().map(layer).collect()
}

/// At most `most` of `0..count`, spread evenly, both ends among them.
fn thinned(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_axis_keeps_its_ends() {
        assert_eq!(thinned(3, 60), [0, 1, 2]);
        let long = thinned(4096, 60);
        assert_eq!((long.len(), long[0], long[59]), (60, 0, 4095));
        assert!(long.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
