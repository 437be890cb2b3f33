//! Data of the page of a lookup table.

use std::collections::BTreeMap;

use kufe_lut::{Axes, CurvatureScaling, Error, Method, Mode, Quantity, Table};
use serde::Serialize;

use crate::results::CaseRecord;

/// Most forces, curvatures and layers (rocker radii, speeds, temperatures of the ice) that the page
/// carries; more are thinned.
const MOST: [usize; 3] = [60, 60, 30];

/// Data of the page of a table.
#[derive(Clone, Debug, Serialize)]
pub struct TablePage<'a> {
    name: &'a str,
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
    unit: &'static str,
    /// Largest measured error by mode.
    errors: BTreeMap<&'static str, Option<f64>>,
    /// Values by layer, force and curvature.
    values: Vec<Vec<Vec<f64>>>,
}

impl<'a> TablePage<'a> {
    /// Of a table that is shown by this name.
    ///
    /// # Errors
    /// Those of the interpolation at the checks.
    pub fn new(table: &'a Table, name: &'a str) -> Result<Self, Error> {
        let axes = table.axes();
        let taken = [
            thinned(axes.fz().len(), MOST[0]),
            thinned(axes.curvature().len(), MOST[1]),
            thinned(axes.layers(), MOST[2]),
        ];
        let pick = |values: &[f64], which: &[usize]| which.iter().map(|&k| values[k]).collect();
        let (layered, layers) = layers(axes, &taken[2]).unzip();
        let mut quantities = Vec::new();
        for &quantity in table.quantities() {
            let mut errors = BTreeMap::new();
            for mode in Mode::ALL {
                let measured = table.interpolation_error(quantity, mode)?;
                errors.insert(mode.name(), measured.map(|m| m.max));
            }
            quantities.push(QuantityData {
                name: quantity.name(),
                unit: quantity.unit(),
                errors,
                values: values(table, axes, quantity, &taken),
            });
        }
        let case: CaseRecord = serde_json::from_str(&table.case).unwrap_or_default();
        Ok(TablePage {
            name,
            fz: pick(axes.fz(), &taken[0]),
            curvature: pick(axes.curvature(), &taken[1]),
            flush: axes.flush().map(CurvatureScaling::numbers),
            layers,
            layered,
            thinned: table.axes().node_count() > taken.iter().map(Vec::len).product(),
            nodes: table.axes().node_count(),
            check_count: table.checks().len(),
            by_boundary_elements: table.solved_by(Method::BoundaryElements),
            quantities,
            solver_error: table.solver_error(),
            judged: table.judged().name(),
            interpolation_requested: table.interpolation_requested,
            case: case.effective(),
            case_sha256: table.origin.case_sha256(),
            version: table.origin.version(),
        })
    }
}

/// Names of the axes besides force and curvature, and of each of their combinations that is taken.
fn layers(axes: &Axes, taken: &[usize]) -> Option<(String, Vec<String>)> {
    let named = [
        ("rocker radius", "m", axes.rocker_radius()),
        ("speed", "m/s", axes.speed()),
        ("ice", "C", axes.ice_c()),
    ];
    let present = named.into_iter().filter(|(_, _, axis)| axis.is_some());
    let titles: Vec<&str> = present.map(|(title, _, _)| title).collect();
    let first = axes.points();
    let name = |&k: &usize| {
        let point = first[k];
        let values = [
            (point.rocker_radius, "m"),
            (point.speed, "m/s"),
            (point.ice_c, "C"),
        ];
        let texts = values
            .into_iter()
            .filter_map(|(value, unit)| Some(format!("{} {unit}", value?)));
        texts.collect::<Vec<_>>().join(", ")
    };
    let names = taken.iter().map(name).collect();
    (!titles.is_empty()).then(|| (titles.join(", "), names))
}

fn values(
    table: &Table,
    axes: &Axes,
    quantity: Quantity,
    taken: &[Vec<usize>; 3],
) -> Vec<Vec<Vec<f64>>> {
    let [forces, curvatures, layers] = taken;
    let values = table.values(quantity).unwrap_or_default();
    let at = |i: usize, j: usize, k: usize| values[axes.node(i, j, k)];
    let row = |i: usize, k: usize| curvatures.iter().map(|&j| at(i, j, k)).collect();
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
