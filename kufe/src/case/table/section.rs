//! The table `[runner.section]`: a measured section, and wear.

use std::path::{Path, PathBuf};

use kufe_mesh::{MeshError, Section, load_points};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::{Bounds, Range};

/// What is known of a runner's section in addition to its shape's radius.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.section"))]
#[serde(deny_unknown_fields)]
pub struct SectionTable {
    /// CSV file of the measured section, columns y_m and z_m, relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<PathBuf>,
    /// The measured section's points (y, z) in the case itself [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points_m: Option<Vec<[f64; 2]>>,
    /// Depth that wear has taken off the lowest point [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worn_m: Option<f64>,
    /// Radius of the flat's edges over the section's own; 0.2 where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worn_edge: Option<f64>,
}

/// Radius of the edges that wear leaves, over the section's own: it rounds them too.
const WORN_EDGE: f64 = 0.2;

impl SectionTable {
    /// `own`, the shape's section, replaced by the measured one where there is one, and worn.
    pub(crate) fn of(&self, own: Section, base: &Path) -> Result<Section, MeshError> {
        let section = match (&self.points_m, &self.profile) {
            (Some(points), _) => section_of(points)?,
            (None, Some(path)) => {
                let path = base.join(path);
                let points = load_points(&path, ["y_m", "z_m"])?;
                section_of(&points).map_err(|error| error.in_file(&path))?
            }
            (None, None) => own,
        };
        match self.worn_m {
            Some(depth) => section.worn(depth, self.worn_edge.unwrap_or(WORN_EDGE)),
            None => Ok(section),
        }
    }
}

/// A section through points whose width is in the range of a shape's.
fn section_of(points: &[[f64; 2]]) -> Result<Section, MeshError> {
    let section = Section::points(points)?;
    let width = points[points.len() - 1][0] - points[0][0];
    if Range::of("runner.shape.width_m").holds(width) {
        return Ok(section);
    }
    Err(MeshError::value(
        format!("section, point {}", points.len()),
        width,
        "a width of the section from 0.0001 to 1 m",
    ))
}
