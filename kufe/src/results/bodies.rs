//! Documents of bodies: an examined hull, and the quality of hexahedra.

use std::path::PathBuf;

use kufe_mesh::{Estimate, HexMesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scanned hull: its frame, its sampling, and the loads that it resolves.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HullCheck {
    /// The hull.
    pub file: PathBuf,
    /// Metres in one unit of the file.
    pub scale: f64,
    /// The file's axis that points up.
    pub up: String,
    /// The file's axis that points forward, or backward: the shape does not show which.
    pub forward: String,
    /// Rotation about z into runner axes; none where the shape does not show it [rad].
    pub yaw_rad: Option<Estimate>,
    /// Rotation about y [rad].
    pub pitch_rad: Option<Estimate>,
    /// Rotation about x [rad].
    pub roll_rad: Option<Estimate>,
    /// Length of the triangles where they are long strips [m].
    pub strips_m: Option<f64>,
    /// Extent along the runner [m].
    pub length_m: f64,
    /// Extent across the runner [m].
    pub width_m: f64,
    /// Extent upwards [m].
    pub height_m: f64,
    /// Radius of the rocker [m].
    pub rocker_radius_m: f64,
    /// Radius of the section where it is lowest [m].
    pub section_radius_m: f64,
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Middle of a hull, along and across, that is not over the file's origin [m].
    pub beyond_origin_m: Option<[f64; 2]>,
    /// Edges of one triangle only.
    pub open_edges: usize,
    /// Median length of the triangles' edges near the keel [m].
    pub spacing_m: f64,
    /// Standard deviation of the vertices' noise [m].
    pub noise_m: f64,
    /// Standard deviation of the noise that would not be detected [m].
    pub unseen_noise_m: f64,
    /// Load by load, where a smooth underside could be fitted.
    pub loads: Option<Vec<ResolvedLoad>>,
    /// Why no smooth underside could be fitted.
    pub no_underside: Option<String>,
    /// Warnings about the hull.
    pub warnings: Vec<String>,
    /// The case that was written.
    pub written: Option<PathBuf>,
}

/// Whether a hull is fine enough for a load, and what would make it finer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ResolvedLoad {
    /// Normal force [N].
    pub fz_n: f64,
    /// Approach under it [m].
    pub approach_m: f64,
    /// Whether the peak is known as well as requested.
    pub resolved: bool,
    /// Relative error of the peak that noise and distances of the vertices leave, as pressing it
    /// would state.
    pub p_max_error: f64,
    /// Estimated error of the surface where it touches [m].
    pub error_m: f64,
    /// The sampling that would be enough, where this one is not.
    pub enough: Option<Sampling>,
    /// The sampling that would halve the error of the peak.
    pub halves: Sampling,
}

/// Noise or spacing of vertices, either of which lowers an error by as much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Sampling {
    /// Noise at the present spacing, where there is some [m].
    pub noise_m: Option<f64>,
    /// Spacing at the present noise [m].
    pub spacing_m: f64,
}

/// `quality.json`: the quality of a case's hexahedra.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "quality.json")]
pub struct MeshQuality {
    /// Version of kufe.
    pub version: String,
    /// Of the ice.
    pub ice: HexQuality,
    /// Of a runner with a top.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runner: Option<HexQuality>,
}

/// The quality of hexahedra.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HexQuality {
    /// Nodes.
    pub nodes: usize,
    /// Cells.
    pub cells: usize,
    /// Cells of negative volume.
    pub inverted: usize,
    /// Smallest scaled Jacobian.
    pub min_scaled_jacobian: f64,
    /// Mean over the cells of their smallest scaled Jacobian.
    pub mean_scaled_jacobian: f64,
    /// Largest ratio of edges.
    pub max_aspect: f64,
    /// Smallest volume of a cell [m3].
    pub min_volume_m3: f64,
    /// Volume [m3].
    pub volume_m3: f64,
}

impl From<&HexMesh> for HexQuality {
    fn from(mesh: &HexMesh) -> Self {
        let quality = mesh.quality();
        HexQuality {
            nodes: mesh.points.len(),
            cells: quality.cells,
            inverted: quality.inverted,
            min_scaled_jacobian: quality.min_scaled_jacobian,
            mean_scaled_jacobian: quality.mean_scaled_jacobian,
            max_aspect: quality.max_aspect,
            min_volume_m3: quality.min_volume,
            volume_m3: quality.volume,
        }
    }
}
