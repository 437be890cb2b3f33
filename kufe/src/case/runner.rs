//! The table `[runner]`: a hull's file, a shape or hexahedra, with section and mount.

use std::path::{Path, PathBuf};

use kufe_contact::{LoadedPlace, Mount, Place};
use kufe_mesh::{Axis, MeshError, Section, load_points};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::range::{Bounds, Range};

/// The runner: a hull, a parametric shape or a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner"))]
#[serde(deny_unknown_fields)]
pub struct RunnerTable {
    /// Hull file (OBJ, glTF/GLB, STL or 3MF), relative to the case's folder.
    pub hull: Option<PathBuf>,
    /// Metres per unit of the hull's file; 0.001 for millimetres.
    pub scale: Option<f64>,
    /// Axis of the hull's file that points up; z where absent, y for glTF.
    pub up: Option<FileAxis>,
    /// Axis of the hull's file that points forward; x where absent.
    pub forward: Option<FileAxis>,
    /// Rotation of a scanned hull into runner axes about z, applied last [rad].
    pub yaw_rad: Option<f64>,
    /// Rotation about y, applied second [rad].
    pub pitch_rad: Option<f64>,
    /// Rotation about x, applied first [rad].
    pub roll_rad: Option<f64>,
    /// Standard deviation of the noise of a hull's vertices or a mesh's nodes; estimated where
    /// absent [m].
    pub noise_m: Option<f64>,
    /// Parametric shape instead of a hull.
    pub shape: Option<Shape>,
    /// A measured section, and wear; for shapes with a section.
    pub section: Option<SectionTable>,
    /// Hexahedral mesh of an elastic runner instead of a hull (.msh of Gmsh, or .vtu), relative to
    /// the case's folder.
    pub mesh: Option<PathBuf>,
    /// Height from the lowest point of an elastic hull to its flat top; to its highest point where
    /// absent [m].
    pub height_m: Option<f64>,
    /// Whether the runner is elastic; rigid where absent.
    #[serde(default)]
    pub elastic: bool,
    /// Young's modulus of the runner [Pa].
    #[serde(default = "steel_modulus")]
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio of the runner.
    #[serde(default = "steel_poisson")]
    pub poissons_ratio: f64,
    /// Mount of an elastic runner; its whole top is clamped where absent.
    pub mount: Option<MountTable>,
}

impl Default for RunnerTable {
    /// Every key absent: a rigid steel runner without geometry.
    fn default() -> Self {
        toml::from_str("").expect("[runner] has no required key")
    }
}

impl From<Shape> for RunnerTable {
    /// A rigid runner of this shape.
    fn from(shape: Shape) -> Self {
        RunnerTable {
            shape: Some(shape),
            ..RunnerTable::default()
        }
    }
}

/// An axis of a hull's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum FileAxis {
    /// +x.
    #[serde(rename = "x")]
    X,
    /// -x.
    #[serde(rename = "-x")]
    MinusX,
    /// +y.
    #[serde(rename = "y")]
    Y,
    /// -y.
    #[serde(rename = "-y")]
    MinusY,
    /// +z.
    #[serde(rename = "z")]
    Z,
    /// -z.
    #[serde(rename = "-z")]
    MinusZ,
}

impl FileAxis {
    pub(super) fn axis(self) -> Axis {
        // In the order of the variants.
        let number = self as usize;
        Axis {
            index: number / 2,
            negative: number % 2 == 1,
        }
    }
}

fn steel_modulus() -> f64 {
    210e9
}

fn steel_poisson() -> f64 {
    0.30
}

/// Parametric runners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.shape"))]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Shape {
    /// A bobsled runner: a round section swept along a rocker, with rounded ends.
    Bob {
        /// Length [m].
        length_m: f64,
        /// Radius of the rocker [m].
        rocker_radius_m: f64,
        /// Radius of the section [m].
        section_radius_m: f64,
        /// Width [m].
        width_m: f64,
        /// Height [m].
        height_m: f64,
    },
    /// An unbounded paraboloid, for verification.
    Paraboloid {
        /// Radius along the runner [m].
        rocker_radius_m: f64,
        /// Radius across the runner [m].
        section_radius_m: f64,
    },
    /// A luge steel on its rounded edge.
    Luge {
        /// Length [m].
        length_m: f64,
        /// Radius of the rocker, made by bending [m].
        rocker_radius_m: f64,
        /// Radius of the edge [m].
        edge_radius_m: f64,
        /// Tilt of the steel's flat underside about x [rad].
        tilt_rad: f64,
        /// Width [m].
        width_m: f64,
        /// Height [m].
        height_m: f64,
    },
}

impl Shape {
    /// Length [m]; `None` for a paraboloid, which is unbounded.
    pub(crate) fn length_m(&self) -> Option<f64> {
        match *self {
            Shape::Bob { length_m, .. } | Shape::Luge { length_m, .. } => Some(length_m),
            Shape::Paraboloid { .. } => None,
        }
    }

    /// Radius of the rocker [m], which every shape has.
    pub fn rocker_radius_m(&mut self) -> &mut f64 {
        match self {
            Shape::Bob {
                rocker_radius_m, ..
            }
            | Shape::Paraboloid {
                rocker_radius_m, ..
            }
            | Shape::Luge {
                rocker_radius_m, ..
            } => rocker_radius_m,
        }
    }
}

/// A measured section of a runner, and its wear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.section"))]
#[serde(deny_unknown_fields)]
pub struct SectionTable {
    /// CSV file of the measured section, columns y_m and z_m, relative to the case's folder.
    pub profile: Option<PathBuf>,
    /// The measured section's points (y, z) in the case itself [m].
    pub points_m: Option<Vec<[f64; 2]>>,
    /// Depth of wear at the lowest point [m].
    pub worn_m: Option<f64>,
    /// Roundness of the worn flat's edges, 0 for sharp ones; 0.2 where absent. Heights are
    /// (v + sqrt(v^2 + e^2)) / 2, with v the height when new less worn_m and e = worn_edge worn_m.
    /// The surface is rounder than a flat with fillets, and its peak lower.
    pub worn_edge: Option<f64>,
}

/// Default ratio of the radius of a worn flat's edges to that of the section: wear rounds edges
/// too.
const WORN_EDGE: f64 = 0.2;

impl SectionTable {
    /// The section with wear: the measured section, or without one `nominal`, that of the shape.
    pub(crate) fn of(&self, nominal: Section, base: &Path) -> Result<Section, MeshError> {
        let section = match (&self.points_m, &self.profile) {
            (Some(points), _) => section_of(points)?,
            (None, Some(path)) => {
                let path = base.join(path);
                let points = load_points(&path, ["y_m", "z_m"])?;
                section_of(&points).map_err(|error| error.in_file(&path))?
            }
            (None, None) => nominal,
        };
        match self.worn_m {
            Some(depth) => section.worn(depth, self.worn_edge.unwrap_or(WORN_EDGE)),
            None => Ok(section),
        }
    }
}

/// A section through points; its width must be in the range of `runner.shape.width_m`.
fn section_of(points: &[[f64; 2]]) -> Result<Section, MeshError> {
    let section = Section::points(points)?;
    let width = points[points.len() - 1][0] - points[0][0];
    if Range::find("runner.shape.width_m").is_some_and(|range| range.holds(width)) {
        return Ok(section);
    }
    Err(MeshError::value(
        format!("section, point {}", points.len()),
        width,
        "a width of the section from 0.0001 to 1 m",
    ))
}

/// Mount of an elastic runner's top: clamped places, or places that transmit fractions of the load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MountTable {
    /// Places that are clamped over the runner's full width.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<HeldTable>,
    /// Places that press the runner down with a fraction of the load each and do not clamp it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub carries: Vec<CarriesTable>,
}

/// A clamped place along the runner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.mount.held"))]
#[serde(deny_unknown_fields)]
pub struct HeldTable {
    /// Its middle [m].
    pub x_m: f64,
    /// Its length [m].
    pub length_m: f64,
}

/// A place along the runner that transmits a fraction of the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.mount.carries"))]
#[serde(deny_unknown_fields)]
pub struct CarriesTable {
    /// Its middle [m].
    pub x_m: f64,
    /// Its length [m].
    pub length_m: f64,
    /// Fraction of the normal force.
    pub share: f64,
}

impl MountTable {
    /// The mount of the problem.
    pub(crate) fn mount(&self) -> Mount {
        let place = |x, length| Place { x, length };
        let held = self.held.iter().map(|p| place(p.x_m, p.length_m));
        let loads = self.carries.iter().map(|p| LoadedPlace {
            place: place(p.x_m, p.length_m),
            share: p.share,
        });
        match self.carries[..] {
            [] => Mount::Places(held.collect()),
            _ => Mount::Loads(loads.collect()),
        }
    }
}
