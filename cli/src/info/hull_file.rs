//! What a hull file holds.

use std::path::Path;

use kufe::jobs::Failure;
use kufe_mesh::{HullOptions, load_hull};
use serde_json::{Value, json};

/// Triangles, extent, holes and warnings of a hull, its coordinates taken as metres.
pub fn describe(path: &Path) -> Result<Value, Failure> {
    let (hull, report) = load_hull(path, &HullOptions::default())
        .map_err(|error| Failure::BadInput(error.to_string()))?;
    let [length, width, height] = report.extent;
    let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    Ok(json!({
        "kind": "hull",
        "vertices": hull.positions.len(),
        "triangles": hull.triangles.len(),
        "length_m": length,
        "width_m": width,
        "height_m": height,
        "volume_m3": report.volume,
        "open_edges": report.open_edges,
        "flipped_edges": report.flipped_edges,
        "warnings": warnings,
    }))
}
