//! Documents of bodies: a checked hull, and the quality of a hexahedral mesh.

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
    /// Rotation about z into runner axes; `None` if the shape does not determine it [rad].
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
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Middle of the hull along and across [m], if the file's origin lies outside its bounds.
    pub beyond_origin_m: Option<[f64; 2]>,
    /// Number of edges that belong to only one triangle.
    pub open_edges: usize,
    /// Median length of the triangles' edges near the keel [m].
    pub spacing_m: f64,
    /// Standard deviation of the vertices' noise [m].
    pub noise_m: f64,
    /// Standard deviation of the noise that would not be detected [m].
    pub unseen_noise_m: f64,
    /// Results for each load; `None` if no smooth underside could be fitted.
    pub loads: Option<Vec<ResolvedLoad>>,
    /// Why no smooth underside could be fitted.
    pub no_underside: Option<String>,
    /// Warnings about the hull.
    pub warnings: Vec<String>,
    /// The case that was written.
    pub written: Option<PathBuf>,
}

/// Whether a hull is fine enough for a load, and the sampling that it would need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ResolvedLoad {
    /// Normal force [N].
    pub fz_n: f64,
    /// Approach under it [m].
    pub approach_m: f64,
    /// Whether the error of the peak is within the requested one, and the vertices determine the
    /// contact: most of its length has vertices.
    pub resolved: bool,
    /// Relative error of the peak due to noise and spacing of the vertices, as in the result of
    /// pressing the hull.
    pub p_max_error: f64,
    /// Estimated error of the surface within the contact [m].
    pub error_m: f64,
    /// The sampling that would suffice; `None` if the present one does.
    pub enough: Option<Sampling>,
    /// The sampling that would halve the error of the peak.
    pub halves: Sampling,
}

/// Two alternatives that lower an error equally: less noise, or a smaller spacing of vertices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Sampling {
    /// Noise at the present spacing; `None` for a hull without noise [m].
    pub noise_m: Option<f64>,
    /// Spacing at the present noise [m].
    pub spacing_m: f64,
}

/// `quality.json`: the quality of a case's hexahedral meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "quality.json")]
pub struct MeshQuality {
    /// Version of kufe.
    pub version: String,
    /// Mesh of the ice.
    pub ice: HexQuality,
    /// Mesh of the runner; absent for a runner without a known top.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runner: Option<HexQuality>,
}

/// The quality of a hexahedral mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HexQuality {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of cells.
    pub cells: usize,
    /// Number of cells of negative volume.
    pub inverted: usize,
    /// Smallest scaled Jacobian.
    pub min_scaled_jacobian: f64,
    /// Mean over the cells of their smallest scaled Jacobian.
    pub mean_scaled_jacobian: f64,
    /// Largest ratio of edge lengths of a cell.
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
