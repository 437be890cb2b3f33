//! The contact problem: runner, ice, track and load.

use std::sync::Arc;

use kufe_fem::ElementKind;
use kufe_mesh::{IceSurface, Underside};

use crate::{Ice, Mount, RunnerSolid};

/// A runner on ice under a load.
#[derive(Clone)]
pub struct Problem {
    /// The runner.
    pub runner: Runner,
    /// The ice.
    pub ice: Ice,
    /// Height of the unloaded ice over the track; `None` for even ice.
    pub ice_surface: Option<Arc<dyn IceSurface>>,
    /// Curvature of the track in the vertical plane, positive in a valley [1/m].
    pub track_curvature: f64,
    /// The load and what may tilt.
    pub load: Load,
}

impl Problem {
    /// A problem on even ice and a track that is straight in the vertical plane.
    pub fn new(runner: Runner, ice: Ice, load: Load) -> Self {
        Problem {
            runner,
            ice,
            ice_surface: None,
            track_curvature: 0.0,
            load,
        }
    }

    /// Compliance of both bodies as half-spaces, 1 / E* [1/Pa]: (1 - nu^2) / E of the ice plus,
    /// where it is elastic, that of the runner.
    pub fn compliance(&self) -> f64 {
        let runner = self.runner.elastic.as_ref();
        self.ice.compliance() + runner.map_or(0.0, ElasticRunner::compliance)
    }
}

// The load and what may tilt under it.

/// The load on the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// The normal force is given.
    Force {
        /// Normal force [N].
        fz: f64,
        /// Line of action along the runner, from the origin [m].
        offset_x: f64,
        /// Line of action across the runner, from the origin [m].
        offset_y: f64,
        /// Whether pitch and roll follow from moment balance.
        tilt: Tilt,
    },
    /// The approach is given and the force follows.
    Approach {
        /// Rigid approach of runner and far ice, measured at the origin from first touch [m].
        approach: f64,
        /// Fixed pitch about y, positive lowers the nose [rad].
        pitch: f64,
        /// Fixed roll about x [rad].
        roll: f64,
    },
}

impl Load {
    /// A normal force [N] through the origin.
    pub fn central(fz: f64, tilt: Tilt) -> Self {
        Load::Force {
            fz,
            offset_x: 0.0,
            offset_y: 0.0,
            tilt,
        }
    }
}

/// Whether the runner may turn about its line of action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tilt {
    /// Pitch and roll follow from the balance of moments.
    Free,
    /// Pitch and roll are fixed.
    Fixed {
        /// Pitch about y, positive lowers the nose [rad].
        pitch: f64,
        /// Roll about x [rad].
        roll: f64,
    },
}

impl Tilt {
    /// Fixed pitch and roll of 0.
    pub const LEVEL: Tilt = Tilt::Fixed {
        pitch: 0.0,
        roll: 0.0,
    };
}

// The pressing body.

/// The pressing body.
#[derive(Clone)]
pub struct Runner {
    /// Its lower surface.
    pub underside: Arc<dyn Underside>,
    /// Its elasticity; `None` for a rigid runner.
    pub elastic: Option<ElasticRunner>,
}

impl Runner {
    /// A rigid runner.
    pub fn rigid(underside: Arc<dyn Underside>) -> Self {
        Runner {
            underside,
            elastic: None,
        }
    }

    /// Whether its hull has finite extents along x and y.
    pub fn is_bounded(&self) -> bool {
        self.underside.extent().iter().all(|end| end.is_finite())
    }
}

/// The elasticity of a runner, its solid and its mount.
///
/// A bounded hull is meshed between its underside and its flat top on the ice's columns, unless a
/// `solid` is given. An unbounded hull (the paraboloid) is a half-space above the contact plane.
#[derive(Clone, Debug)]
pub struct ElasticRunner {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Height of the flat top over the contact plane [m]; not used by an unbounded hull, nor by a
    /// solid.
    pub top: f64,
    /// Mount of the meshed runner.
    pub mount: Mount,
    /// Largest slope of the meshed solid's underside; `None` for the default of its mount
    /// ([`Mount::flank`]).
    ///
    /// Where the hull is steeper, the solid continues straight at this slope: it has more steel
    /// next to the contact, the gap does not change.
    pub flank: Option<f64>,
    /// Unstructured hexahedra of the runner; `None` if it is meshed on the ice's columns.
    pub solid: Option<Arc<RunnerSolid>>,
}

impl ElasticRunner {
    /// Compliance as a half-space, (1 - nu^2) / E [1/Pa].
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus
    }

    /// A runner fixed at its flat top.
    pub fn fixed_at_top(youngs_modulus: f64, poissons_ratio: f64, top: f64) -> Self {
        ElasticRunner {
            youngs_modulus,
            poissons_ratio,
            top,
            mount: Mount::Top,
            flank: None,
            solid: None,
        }
    }

    /// Element of its hexahedra; on the ice's columns it depends on the mount.
    pub fn element_kind(&self) -> ElementKind {
        match self.solid {
            Some(_) => ElementKind::Hex8Incompatible,
            None => self.mount.element(self.poissons_ratio),
        }
    }
}
