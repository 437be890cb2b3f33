//! The table `[sliding]`: a runner that slides on ice that yields.

use std::path::PathBuf;

use kufe_contact::{ice_hardness, ice_melting_pressure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

/// Steady sliding towards +x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("sliding"))]
#[serde(deny_unknown_fields)]
pub struct SlidingTable {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice, which gives its hardness where nothing else does, and what heat it
    /// takes [C].
    pub ice_c: f64,
    /// Factor on the viscosity of the film's water; 1 where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity_factor: Option<f64>,
    /// Standard deviation of the heights of steel and ice together; 0, the film alone, where absent
    /// [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roughness_m: Option<f64>,
    /// Shear stress where steel and ice touch through the film; 0 where absent [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary_shear_pa: Option<f64>,
    /// Output folder of the runner that went before, whose groove this one meets, relative to the
    /// case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub previous: Option<PathBuf>,
    /// A measured hardness from which the law of creep says that of this temperature and of the
    /// time under the runner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    /// Speed [m/s] and temperature [C], all else as where the table does not say.
    pub fn new(v_mps: f64, ice_c: f64) -> Self {
        SlidingTable {
            v_mps,
            ice_c,
            viscosity_factor: None,
            roughness_m: None,
            boundary_shear_pa: None,
            previous: None,
            hardness: None,
        }
    }

    /// The pressure at which the ice yields [Pa]: `stated` where there is one, the anchor of the
    /// law of creep, which does not say more without a contact time, or what its temperature says;
    /// at most that at which it melts.
    pub fn hardness(&self, stated: Option<f64>) -> f64 {
        let anchor = self.hardness.map(|anchor| anchor.pressure_pa);
        let own = stated
            .or(anchor)
            .unwrap_or_else(|| ice_hardness(self.ice_c));
        own.min(ice_melting_pressure(self.ice_c))
    }
}
