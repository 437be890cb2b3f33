//! The table `[ice]`: what is pressed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kufe_mesh::{IceSurface, Waviness, load_height_map};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words::{Hardness, Thickness};
use crate::case::CaseError;
use kufe_contact::{Bed, Foundation, ICE_POISSONS_RATIO, Ice, ice_hardness, ice_youngs_modulus};

/// The pressed body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IceTable {
    /// Temperature of the ice, which gives the elastic constants that are not stated [C].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -50.0, max = 0.0))]
    pub temperature_c: Option<f64>,
    /// Young's modulus; from the temperature where absent [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e6, max = 1e13))]
    pub youngs_modulus_pa: Option<f64>,
    /// Poisson's ratio; that of polycrystalline ice where absent and a temperature is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 0.499))]
    pub poissons_ratio: Option<f64>,
    /// Thickness on its bed, or a half-space.
    pub thickness_m: Thickness,
    /// An elastic layer under the ice; a rigid bed where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bed: Option<BedTable>,
    /// Largest pressure the surface bears, where stated [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hardness_pa: Option<Hardness>,
    /// Waves on the ice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waviness: Option<WavinessTable>,
    /// File of a measured ice surface (CSV or EXR), relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<PathBuf>,
}

/// The concrete under the ice, on a rigid bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BedTable {
    /// Young's modulus [Pa].
    #[schemars(range(min = 1e6, max = 1e13))]
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    #[schemars(range(min = 0.0, max = 0.499))]
    pub poissons_ratio: f64,
    /// Thickness [m].
    #[schemars(range(min = 0.001, max = 100.0))]
    pub thickness_m: f64,
}

/// Sinusoidal waves on the ice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WavinessTable {
    /// Half the height from trough to crest [m].
    #[schemars(range(min = -0.01, max = 0.01))]
    pub amplitude_m: f64,
    /// Distance from crest to crest [m].
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub wavelength_m: f64,
    /// Angle between the waves' direction and x; 0, along the runner, where absent [rad].
    #[serde(default)]
    #[schemars(range(min = -10.0, max = 10.0))]
    pub direction_rad: f64,
    /// Phase at the origin; 0, a crest, where absent [rad].
    #[serde(default)]
    #[schemars(range(min = -100.0, max = 100.0))]
    pub phase_rad: f64,
}

impl IceTable {
    /// The material and what carries it; the table has been checked.
    pub(crate) fn ice(&self) -> Ice {
        let of_temperature =
            |function: fn(f64) -> f64| self.temperature_c.map_or(f64::NAN, function);
        Ice {
            youngs_modulus: self
                .youngs_modulus_pa
                .unwrap_or_else(|| of_temperature(ice_youngs_modulus)),
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
                Hardness::FromTemperature => of_temperature(ice_hardness),
                Hardness::Stated(pressure) => pressure,
            }),
        }
    }

    /// The ice's surface; a height map's path is taken from `base`.
    pub(crate) fn surface(&self, base: &Path) -> Result<Option<Arc<dyn IceSurface>>, CaseError> {
        if let Some(path) = &self.surface {
            let map = load_height_map(&base.join(path)).map_err(CaseError::IceSurface)?;
            return Ok(Some(Arc::new(map)));
        }
        let Some(waves) = &self.waviness else {
            return Ok(None);
        };
        let waves = Waviness {
            direction: waves.direction_rad,
            phase: waves.phase_rad,
            ..Waviness::new(waves.amplitude_m, waves.wavelength_m).map_err(CaseError::IceSurface)?
        };
        Ok(Some(Arc::new(waves)))
    }
}
