//! Parametric runners as a case states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::check::range::Bounds;

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
