//! What a case says of an elastic runner's mount.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

use crate::case::CaseError;
use kufe_contact::{LoadedPlace, Mount, Place};

/// What holds an elastic runner's top: some places along it, or nothing but the places that carry
/// its load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MountTable {
    /// Places that are clamped over the runner's full width.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<HeldTable>,
    /// Places that press the runner down with a share of the load each; nothing else holds it.
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

/// A place along the runner that carries a share of the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = Bounds("runner.mount.carries"))]
#[serde(deny_unknown_fields)]
pub struct CarriesTable {
    /// Its middle [m].
    pub x_m: f64,
    /// Its length [m].
    pub length_m: f64,
    /// Part of the normal force.
    pub share: f64,
}

impl MountTable {
    /// The mount of the problem.
    pub(crate) fn mount(&self) -> Mount {
        let place = |x, length| Place { x, length };
        if self.carries.is_empty() {
            let places = self.held.iter();
            return Mount::Places(places.map(|p| place(p.x_m, p.length_m)).collect());
        }
        let loads = self.carries.iter().map(|p| LoadedPlace {
            place: place(p.x_m, p.length_m),
            share: p.share,
        });
        Mount::Loads(loads.collect())
    }
}

/// Fails with a mesh that cannot be had.
pub(crate) fn mesh_error(reason: impl ToString) -> CaseError {
    CaseError::Mesh {
        reason: reason.to_string(),
    }
}
