//! Parametric runners as a case states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parametric runners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Shape {
    /// A bobsled runner: a round section swept along a rocker, with rounded ends.
    Bob {
        /// Length [m].
        #[schemars(range(min = 0.01, max = 10.0))]
        length_m: f64,
        /// Radius of the rocker [m].
        #[schemars(range(min = 0.05))]
        rocker_radius_m: f64,
        /// Radius of the section [m].
        #[schemars(range(min = 1e-4))]
        section_radius_m: f64,
        /// Width [m].
        #[schemars(range(min = 1e-4, max = 1.0))]
        width_m: f64,
        /// Height [m].
        #[schemars(range(min = 0.001, max = 1.0))]
        height_m: f64,
    },
    /// An unbounded paraboloid, for verification.
    Paraboloid {
        /// Radius along the runner [m].
        #[schemars(range(min = 0.05))]
        rocker_radius_m: f64,
        /// Radius across the runner [m].
        #[schemars(range(min = 1e-4))]
        section_radius_m: f64,
    },
    /// A luge steel on its rounded edge.
    Luge {
        /// Length [m].
        #[schemars(range(min = 0.01, max = 10.0))]
        length_m: f64,
        /// Radius of the rocker, made by bending [m].
        #[schemars(range(min = 0.05))]
        rocker_radius_m: f64,
        /// Radius of the edge [m].
        #[schemars(range(min = 1e-4, max = 1.0))]
        edge_radius_m: f64,
        /// Tilt of the steel's flat underside about x [rad].
        #[schemars(range(min = -1.0, max = 1.0))]
        tilt_rad: f64,
        /// Width [m].
        #[schemars(range(min = 1e-4, max = 1.0))]
        width_m: f64,
        /// Height [m].
        #[schemars(range(min = 0.001, max = 1.0))]
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
