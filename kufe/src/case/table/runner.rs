//! What a case says of the runner.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::mount::MountTable;
use super::section::SectionTable;
use super::shape::Shape;
use crate::case::check::range::Bounds;

/// The pressing body: a hull's file or a parametric shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner"))]
#[serde(deny_unknown_fields)]
pub struct RunnerTable {
    /// Hull file (OBJ, glTF/GLB, STL or 3MF), relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hull: Option<PathBuf>,
    /// Metres per unit of the hull's file; 0.001 for millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The hull's upward axis: z, or y as glTF has it, where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<FileAxis>,
    /// The hull's forward axis; x where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward: Option<FileAxis>,
    /// Rotation about z, the last of the three, that carries a scanned hull into runner axes [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw_rad: Option<f64>,
    /// Rotation about y, the second [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pitch_rad: Option<f64>,
    /// Rotation about x, the first [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_rad: Option<f64>,
    /// Standard deviation of the vertices of a hull or a mesh; found where absent [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_m: Option<f64>,
    /// Parametric shape instead of a hull.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// A measured section, and wear; for shapes with a section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<SectionTable>,
    /// Hexahedra of an elastic runner instead (Gmsh's .msh or .vtu), relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<PathBuf>,
    /// Height from the lowest point of an elastic hull to its flat top; its highest place where
    /// absent [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Whether the runner deforms.
    #[serde(default)]
    pub elastic: bool,
    /// Young's modulus of the runner [Pa].
    #[serde(default = "steel_modulus")]
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio of the runner.
    #[serde(default = "steel_poisson")]
    pub poissons_ratio: f64,
    /// What holds an elastic runner; its whole top where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mount: Option<MountTable>,
}

impl From<Shape> for RunnerTable {
    /// A rigid runner of this shape.
    fn from(shape: Shape) -> Self {
        RunnerTable {
            hull: None,
            scale: None,
            up: None,
            forward: None,
            yaw_rad: None,
            pitch_rad: None,
            roll_rad: None,
            noise_m: None,
            shape: Some(shape),
            section: None,
            mesh: None,
            height_m: None,
            elastic: false,
            youngs_modulus_pa: steel_modulus(),
            poissons_ratio: steel_poisson(),
            mount: None,
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

fn steel_modulus() -> f64 {
    210e9
}

fn steel_poisson() -> f64 {
    0.30
}
