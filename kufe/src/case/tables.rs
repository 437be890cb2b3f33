//! The tables of a case other than `[runner]`: ice, track, load, sliding, accuracy and solver.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kufe_contact::{
    Bed, Foundation, ICE_POISSONS_RATIO, Ice, Load, StiffnessForm, Tilt, ice_hardness,
    ice_melting_pressure, ice_youngs_modulus,
};
use kufe_mesh::{IceSurface, Waviness, load_height_map};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::case::CaseError;
use crate::case::range::{Bounds, Range};

/// The ice, which the runner is pressed on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("ice"))]
#[serde(deny_unknown_fields)]
pub struct IceTable {
    /// Temperature of the ice, from which elastic constants that are not stated are computed [C].
    pub temperature_c: Option<f64>,
    /// Young's modulus; computed from the temperature where absent [Pa].
    pub youngs_modulus_pa: Option<f64>,
    /// Poisson's ratio; with a temperature, that of polycrystalline ice where absent.
    pub poissons_ratio: Option<f64>,
    /// Thickness on its bed, or a half-space.
    pub thickness_m: Thickness,
    /// An elastic layer under the ice; a rigid bed where absent.
    pub bed: Option<BedTable>,
    /// Hardness: largest pressure that the surface bears; elastic where absent [Pa].
    pub hardness_pa: Option<Hardness>,
    /// Waves on the ice.
    pub waviness: Option<WavinessTable>,
    /// File of a measured ice surface (CSV or EXR), relative to the case's folder.
    pub surface: Option<PathBuf>,
}

/// The concrete under the ice, on a rigid bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("ice.bed"))]
#[serde(deny_unknown_fields)]
pub struct BedTable {
    /// Young's modulus [Pa].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Thickness [m].
    pub thickness_m: f64,
}

/// Sinusoidal waves on the ice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("ice.waviness"))]
#[serde(deny_unknown_fields)]
pub struct WavinessTable {
    /// Half the height from trough to crest [m].
    pub amplitude_m: f64,
    /// Distance from crest to crest [m].
    pub wavelength_m: f64,
    /// Angle between the waves' direction and x; 0, along the runner, where absent [rad].
    #[serde(default)]
    pub direction_rad: f64,
    /// Phase at the origin; 0, a crest, where absent [rad].
    #[serde(default)]
    pub phase_rad: f64,
}

impl IceTable {
    /// An elastic half-space of ice with Young's modulus [Pa] and Poisson's ratio.
    pub fn half_space(youngs_modulus_pa: f64, poissons_ratio: f64) -> Self {
        IceTable {
            youngs_modulus_pa: Some(youngs_modulus_pa),
            poissons_ratio: Some(poissons_ratio),
            ..IceTable::default()
        }
    }

    /// The material and its foundation; the table must have been checked.
    pub(crate) fn ice(&self) -> Ice {
        let from_temperature =
            |function: fn(f64) -> f64| self.temperature_c.map_or(f64::NAN, function);
        Ice {
            youngs_modulus: self
                .youngs_modulus_pa
                .unwrap_or_else(|| from_temperature(ice_youngs_modulus)),
            poissons_ratio: self.poissons_ratio.unwrap_or(ICE_POISSONS_RATIO),
            foundation: match (self.thickness_m, &self.bed) {
                (Thickness::HalfSpace, _) => Foundation::HalfSpace,
                (Thickness::Layer(thickness), None) => Foundation::RigidBed { thickness },
                (Thickness::Layer(thickness), Some(bed)) => Foundation::ElasticBed {
                    thickness,
                    bed: Bed {
                        youngs_modulus: bed.youngs_modulus_pa,
                        poissons_ratio: bed.poissons_ratio,
                        thickness: bed.thickness_m,
                    },
                },
            },
            hardness: self.hardness_pa.map(|hardness| match hardness {
                Hardness::FromTemperature => from_temperature(ice_hardness),
                Hardness::Stated(pressure) => pressure,
            }),
        }
    }

    /// The surface of uneven ice; the path of a height map is relative to `base`.
    pub(crate) fn surface(&self, base: &Path) -> Result<Option<Arc<dyn IceSurface>>, CaseError> {
        if let Some(path) = &self.surface {
            let map =
                load_height_map(&base.join(path)).map_err(CaseError::in_file("ice.surface"))?;
            return Ok(Some(Arc::new(map)));
        }
        let Some(waves) = &self.waviness else {
            return Ok(None);
        };
        let waves = Waviness {
            direction: waves.direction_rad,
            phase: waves.phase_rad,
            ..Waviness::new(waves.amplitude_m, waves.wavelength_m)
                .map_err(CaseError::in_file("ice.surface"))?
        };
        Ok(Some(Arc::new(waves)))
    }
}

/// Hardness: the largest pressure that the ice bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hardness {
    /// Computed from the ice's temperature, written `"from-temperature"`.
    FromTemperature,
    /// A stated pressure [Pa].
    Stated(f64),
}

/// Thickness of the ice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Thickness {
    /// A half-space of ice, written `"half-space"`.
    #[default]
    HalfSpace,
    /// A layer on its bed [m].
    Layer(f64),
}

/// Implements reading and writing of `$name` as the word of its variant `$of_word` or the number of
/// its variant `$of_number`, with the range of `$key`.
macro_rules! word_or_number {
    ($name:ident, $of_word:ident = $word:literal, $of_number:ident = $number:literal, $key:literal, $description:literal) => {
        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match self {
                    $name::$of_word => serializer.serialize_str($word),
                    $name::$of_number(value) => serializer.serialize_f64(*value),
                }
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let read = number_or(deserializer, $word, $number)?;
                Ok(read.map_or($name::$of_word, $name::$of_number))
            }
        }

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                let range = Range::find($key).expect("a range");
                json_schema!({
                    "description": $description,
                    "anyOf": [
                        { "type": "number", "minimum": range.low, "maximum": range.high },
                        { "const": $word },
                    ],
                })
            }
        }
    };
}

word_or_number!(
    Hardness,
    FromTemperature = "from-temperature",
    Stated = "a pressure in pascals",
    "ice.hardness_pa",
    "Hardness of the ice [Pa], or \"from-temperature\"."
);
word_or_number!(
    Thickness,
    HalfSpace = "half-space",
    Layer = "a thickness in metres",
    "ice.thickness_m",
    "Thickness of the ice on its bed [m], or \"half-space\"."
);

/// Reads a number, or `None` for `word`; `what` describes the number in messages.
fn number_or<'de, D: Deserializer<'de>>(
    deserializer: D,
    word: &str,
    what: &str,
) -> Result<Option<f64>, D::Error> {
    match toml::Value::deserialize(deserializer)? {
        toml::Value::Float(value) => Ok(Some(value)),
        toml::Value::Integer(value) => Ok(Some(value as f64)),
        toml::Value::String(found) if found == word => Ok(None),
        found => Err(D::Error::custom(format!(
            "found {found}, expected {what} or \"{word}\""
        ))),
    }
}

/// The track under the runner: a radius or a curvature in the vertical plane, flat where neither is
/// given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("track"))]
#[serde(deny_unknown_fields)]
pub struct TrackTable {
    /// Radius, positive in a valley, `inf` on a straight [m].
    pub radius_m: Option<f64>,
    /// Curvature, positive in a valley [1/m].
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

/// The load, and the tilt of the runner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("load"))]
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
    /// Whether pitch and roll are free (in equilibrium) or fixed.
    #[serde(default)]
    pub tilt: TiltWord,
    /// Pitch about y where fixed, positive lowers the nose; 0 where absent [rad].
    pub pitch_rad: Option<f64>,
    /// Roll about x where fixed; 0 where absent [rad].
    pub roll_rad: Option<f64>,
}

impl LoadTable {
    /// The load of the problem, without effects.
    pub fn load(&self) -> Load {
        Load::Force {
            fz: self.fz_n,
            offset_x: self.offset_x_m,
            offset_y: self.offset_y_m,
            tilt: match self.tilt {
                TiltWord::Free => Tilt::Free,
                TiltWord::Fixed => Tilt::Fixed {
                    pitch: self.pitch_rad.unwrap_or(0.0),
                    roll: self.roll_rad.unwrap_or(0.0),
                },
            },
        }
    }
}

/// Whether pitch and roll are free or fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TiltWord {
    /// Pitch and roll settle where the moments balance.
    #[default]
    Free,
    /// Pitch and roll are fixed.
    Fixed,
}

/// Steady sliding towards +x.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("sliding"))]
#[serde(deny_unknown_fields)]
pub struct SlidingTable {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice, which determines the heat flow into it and, where nothing else
    /// states it, its hardness [C].
    pub ice_c: f64,
    /// Factor on the viscosity of the film's water; 1 where absent.
    pub viscosity_factor: Option<f64>,
    /// Combined standard deviation of the surface heights of steel and ice; 0 (no boundary contact)
    /// where absent [m].
    pub roughness_m: Option<f64>,
    /// Shear stress of boundary contact (steel on ice through the film); 0 where absent [Pa].
    pub boundary_shear_pa: Option<f64>,
    /// Output folder of the preceding runner, in whose groove this one slides, relative to the
    /// case's folder.
    pub previous: Option<PathBuf>,
    /// A measured hardness, from which the law of creep computes the hardness at this temperature
    /// and contact time.
    pub hardness: Option<HardnessTable>,
}

/// A hardness measured at one temperature within one contact time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("sliding.hardness"))]
#[serde(deny_unknown_fields)]
pub struct HardnessTable {
    /// The hardness [Pa].
    pub pressure_pa: f64,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// Time within which the indentation was made [s].
    pub contact_time_s: f64,
}

impl SlidingTable {
    /// The hardness of the ice [Pa], bounded by the melting pressure.
    ///
    /// It is `stated`, or else the measured hardness (the law of creep needs a contact time and is
    /// not applied here), or else computed from the ice's temperature.
    pub fn hardness(&self, stated: Option<f64>) -> f64 {
        let anchor = self.hardness.map(|anchor| anchor.pressure_pa);
        let hardness = stated
            .or(anchor)
            .unwrap_or_else(|| ice_hardness(self.ice_c));
        hardness.min(ice_melting_pressure(self.ice_c))
    }
}

/// Requested accuracy of the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("accuracy"))]
#[serde(deny_unknown_fields)]
pub struct AccuracyTable {
    /// Requested relative discretisation error of the peak pressure.
    pub p_max: f64,
}

impl Default for AccuracyTable {
    fn default() -> Self {
        AccuracyTable { p_max: 0.01 }
    }
}

/// Options of the solver.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverTable {
    /// Form of the stiffness matrix in products.
    #[serde(default)]
    pub stiffness: StiffnessWord,
}

impl SolverTable {
    /// Whether all values are the defaults.
    pub(crate) fn is_default(&self) -> bool {
        *self == SolverTable::default()
    }
}

/// Form of the stiffness matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StiffnessWord {
    /// Applied cell by cell, without being stored.
    #[default]
    MatrixFree,
    /// Assembled into one sparse matrix per body, of at most 4 GB.
    Assembled,
}

impl From<StiffnessWord> for StiffnessForm {
    fn from(word: StiffnessWord) -> Self {
        match word {
            StiffnessWord::MatrixFree => StiffnessForm::MatrixFree,
            StiffnessWord::Assembled => StiffnessForm::Assembled,
        }
    }
}
