//! The file that states one contact problem, `case.toml`.
//!
//! [`Case`] mirrors the file key by key; [`Case::parse`] reads and checks it, [`Case::problem`]
//! turns it into a [`Problem`](crate::Problem). Unknown keys are errors, and every error names the
//! line, the key, the value found and what was expected.
//!
//! ```
//! use kufe_contact::case::Case;
//! let case = Case::parse(
//!     "[runner]\n\
//!      shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
//!      [ice]\n\
//!      youngs_modulus_pa = 9.0e9\n\
//!      poissons_ratio = 0.33\n\
//!      thickness_m = \"half-space\"\n\
//!      [load]\n\
//!      fz_n = 1000.0\n",
//! )?;
//! assert_eq!(case.load.fz_n, 1000.0);
//! assert_eq!(case.track.curvature(), 0.0);
//! # Ok::<(), kufe_contact::case::CaseError>(())
//! ```

mod check;
mod error;
mod hardness;
mod ice;
mod mount;
mod problem;
mod section;
mod thickness;
mod word_or_number;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use error::CaseError;
pub use hardness::Hardness;
pub use ice::{BedTable, IceTable, WavinessTable};
pub use mount::{CarriesTable, HeldTable, MountTable};
pub use problem::{FittedHull, StatedProblem};
pub use section::SectionTable;
pub use thickness::Thickness;

/// One contact problem as a file states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "case.toml")]
pub struct Case {
    /// The runner.
    pub runner: RunnerTable,
    /// The ice.
    pub ice: IceTable,
    /// The track under the runner; flat where the table is absent.
    #[serde(default)]
    pub track: TrackTable,
    /// The load.
    pub load: LoadTable,
    /// The accuracy asked; one per cent of the peak pressure where the table is absent.
    #[serde(default)]
    pub accuracy: AccuracyTable,
    /// Effects that are switched on, by name ([`crate::effects`]); an absent one is off.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(schema_with = "crate::effects::schema::schema")]
    pub effects: BTreeMap<String, toml::Table>,
}

/// The pressing body: a hull's file or a parametric shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunnerTable {
    /// Hull file (OBJ, glTF/GLB or STL), relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hull: Option<PathBuf>,
    /// Metres per unit of the hull's file; 0.001 for millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The hull's upward axis; z where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// The hull's forward axis; x where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward: Option<ForwardAxis>,
    /// Standard deviation of a scanned hull's vertices; 0 where absent [m].
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

/// The axis of a hull's file that points upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// z, this project's own.
    Z,
    /// y, glTF's own.
    Y,
}

/// The axis of a hull's file that points forwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ForwardAxis {
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

/// Parametric runners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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

/// The track under the runner: a radius or a curvature in the vertical plane, flat where neither is given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackTable {
    /// Radius, positive in a valley, `inf` on a straight [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Curvature, positive in a valley [1/m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curvature_1pm: Option<f64>,
}

impl TrackTable {
    /// Curvature, 0 for an infinite radius and where nothing is given [1/m].
    pub fn curvature(&self) -> f64 {
        match (self.curvature_1pm, self.radius_m) {
            (Some(curvature), _) => curvature,
            (None, Some(radius)) => 1.0 / radius,
            (None, None) => 0.0,
        }
    }
}

/// The load and what may tilt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadTable {
    /// Normal force [N].
    pub fz_n: f64,
    /// Line of action along the runner [m].
    #[serde(default)]
    pub offset_x_m: f64,
    /// Line of action across the runner [m].
    #[serde(default)]
    pub offset_y_m: f64,
    /// Whether pitch and roll settle in equilibrium.
    #[serde(default)]
    pub tilt: TiltWord,
    /// Pitch about y where fixed, positive lowers the nose; 0 where absent [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pitch_rad: Option<f64>,
    /// Roll about x where fixed; 0 where absent [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_rad: Option<f64>,
}

/// Whether the runner may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TiltWord {
    /// Pitch and roll settle where the moments balance.
    #[default]
    Free,
    /// Pitch and roll are held.
    Fixed,
}

/// How accurate the answer must be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AccuracyTable {
    /// Relative discretisation error asked of the peak pressure.
    pub p_max: f64,
}

impl Default for AccuracyTable {
    fn default() -> Self {
        AccuracyTable { p_max: 0.01 }
    }
}

fn steel_modulus() -> f64 {
    210e9
}

fn steel_poisson() -> f64 {
    0.30
}

impl Case {
    /// Reads and checks a case.
    ///
    /// # Errors
    /// [`CaseError`] with the line, the key, the value and what was expected.
    pub fn parse(text: &str) -> Result<Case, CaseError> {
        let case: Case =
            toml::from_str(text).map_err(|error| CaseError::from_toml(text, &error))?;
        case.check().map_err(|error| error.locate(text))?;
        Ok(case)
    }

    /// The files that the case names, as it names them: hull, section, ice surface.
    pub fn files(&self) -> Vec<&Path> {
        let profile = self
            .runner
            .section
            .as_ref()
            .and_then(|s| s.profile.as_ref());
        [
            self.runner.hull.as_ref(),
            profile,
            self.ice.surface.as_ref(),
        ]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect()
    }

    /// The case as TOML; [`Case::parse`] of it gives the case back.
    ///
    /// # Errors
    /// [`CaseError::Unwritable`] where the hull's path is not valid Unicode.
    pub fn to_toml(&self) -> Result<String, CaseError> {
        toml::to_string(self).map_err(|error| CaseError::Unwritable {
            reason: error.to_string(),
        })
    }
}
