//! What a lookup table holds.

use std::path::Path;

use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{Method, Mode, Quantity, Table, read_fmu};
use serde_json::{Map, Value, json};

/// Axes, quantities with their ranges and interpolation errors, the solver's error, case and version.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    facts(&read_table(path)?, path)
}

/// The table in an FMU, and the platforms that it has libraries for.
pub fn describe_fmu(path: &Path) -> Result<Value, Failure> {
    let told =
        |reason: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {reason}", path.display()));
    let file = kufe_files::open_regular(path)
        .map_err(|error| told(&format!("cannot be read: {error}")))?;
    let unit = read_fmu(std::io::BufReader::new(file)).map_err(|error| told(&error))?;
    let mut facts = facts(&unit.table, path)?;
    facts["kind"] = json!("a lookup table as an FMU (FMI 3.0)");
    facts["written_by"] = json!("kufe lut --fmu");
    facts["platforms"] = json!(unit.platforms.join(", "));
    Ok(facts)
}

fn facts(table: &Table, path: &Path) -> Result<Value, Failure> {
    let told = |error| Failure::BadInput(format!("{}: {error}", path.display()));
    let mut quantities = Map::new();
    for &quantity in table.quantities() {
        quantities.insert(
            quantity.key().into(),
            figures(table, quantity).map_err(told)?,
        );
    }
    let mut axes = Map::new();
    let range = table.axes().curvature_range(table.axes().fz()[0]);
    axes.insert(
        "curvature_1pm".into(),
        json!({ "points": table.axes().curvature().len(), "from": range[0], "to": range[1] }),
    );
    for (name, _, values) in table.axes().named() {
        if !name.ends_with("curvature_1pm") && name != "reduced_curvature" {
            axes.insert(name.into(), axis(values));
        }
    }
    let solver = format!("solver_error_{}", table.judged().name());
    Ok(json!({
        "kind": "lookup table",
        "written_by": "kufe lut",
        "axes": axes,
        "quantities": quantities,
        "nodes": table.axes().node_count(),
        "checks": table.checks().len(),
        "by_boundary_elements": table.solved_by(Method::BoundaryElements),
        solver: table.solver_error(),
        "interpolation_requested": table.interpolation_requested,
        "case_sha256": table.origin.case_sha256(),
        "version": table.origin.version(),
    }))
}

fn axis(values: &[f64]) -> Value {
    json!({ "points": values.len(), "from": values.first(), "to": values.last() })
}

/// Smallest and largest value, and the largest relative error of each mode where there are checks.
fn figures(table: &Table, quantity: Quantity) -> Result<Value, kufe_lut::Error> {
    let values = || table.values(quantity).unwrap_or_default().iter().copied();
    let mut figures = Map::new();
    figures.insert("min".into(), values().fold(f64::INFINITY, f64::min).into());
    figures.insert(
        "max".into(),
        values().fold(f64::NEG_INFINITY, f64::max).into(),
    );
    for mode in Mode::ALL {
        if let Some(measured) = table.interpolation_error(quantity, mode)? {
            figures.insert(format!("{}_error", mode.name()), measured.max.into());
        }
    }
    Ok(figures.into())
}
