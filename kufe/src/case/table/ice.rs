//! The table `[ice]`: what is pressed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kufe_mesh::{IceSurface, Waviness, load_height_map};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words::{Hardness, Thickness};
use crate::case::CaseError;
use crate::case::check::range::Bounds;
use kufe_contact::{Bed, Foundation, ICE_POISSONS_RATIO, Ice, ice_hardness, ice_youngs_modulus};

/// The pressed body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("ice"))]
#[serde(deny_unknown_fields)]
pub struct IceTable {
    /// Temperature of the ice, which gives the elastic constants that are not stated [C].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_c: Option<f64>,
    /// Young's modulus; from the temperature where absent [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub youngs_modulus_pa: Option<f64>,
    /// Poisson's ratio; that of polycrystalline ice where absent and a temperature is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    /// Ice without end, with this modulus [Pa] and Poisson's ratio.
    pub fn half_space(youngs_modulus_pa: f64, poissons_ratio: f64) -> Self {
        IceTable {
            temperature_c: None,
            youngs_modulus_pa: Some(youngs_modulus_pa),
            poissons_ratio: Some(poissons_ratio),
            thickness_m: Thickness::HalfSpace,
            bed: None,
            hardness_pa: None,
            waviness: None,
            surface: None,
        }
    }

    /// Ice of this thickness on a rigid bed [m].
    #[must_use]
    pub fn on_rigid_bed(self, thickness_m: f64) -> Self {
        IceTable {
            thickness_m: Thickness::Layer(thickness_m),
            ..self
        }
    }

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
