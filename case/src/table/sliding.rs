//! The table `[sliding]`: a runner that slides on ice that yields.

use std::path::PathBuf;

use kufe_contact::{ice_hardness, ice_melting_pressure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Steady sliding towards +x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlidingTable {
    /// Speed [m/s].
    #[schemars(range(min = 0.01, max = 100.0))]
    pub v_mps: f64,
    /// Temperature of the ice, which gives its hardness where ice.hardness_pa does not, and what heat it takes [C].
    #[schemars(range(min = -50.0, max = -0.1))]
    pub ice_c: f64,
    /// Factor on the viscosity of the film's water; 1 where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.01, max = 1000.0))]
    pub viscosity_factor: Option<f64>,
    /// Output folder of the runner that went before, whose groove this one meets, relative to the case's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub previous: Option<PathBuf>,
}

impl SlidingTable {
    /// The pressure at which ice of this temperature yields or melts, whichever is less [Pa].
    pub fn hardness(&self) -> f64 {
        ice_hardness(self.ice_c).min(ice_melting_pressure(self.ice_c))
    }
}
