//! The pressing body.

use std::sync::Arc;

use kufe_fem::ElementKind;
use kufe_mesh::Underside;

use crate::{Mount, RunnerSolid};

/// The pressing body.
#[derive(Clone)]
pub struct Runner {
    /// Its lower surface.
    pub underside: Arc<dyn Underside>,
    /// Its elasticity; rigid where absent.
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
}

/// The elasticity of a runner, its solid and what holds it.
///
/// A bounded hull is meshed between its underside and its flat top on the ice's columns, unless it brings a `solid`. An
/// unbounded one (the paraboloid) is a half-space above the contact plane.
#[derive(Clone, Debug)]
pub struct ElasticRunner {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Height of the flat top over the contact plane [m]; not used by an unbounded hull, nor by a solid.
    pub top: f64,
    /// What holds the meshed runner.
    pub mount: Mount,
    /// Steepest slope of the meshed solid's underside, where its mount's own ([`Mount::flank`]) is not to be taken.
    ///
    /// Where the hull is steeper the solid goes on straight at this slope: it gains steel beside the contact, the gap does
    /// not change.
    pub flank: Option<f64>,
    /// The element of the hexahedra on the ice's columns, where its mount's own ([`Mount::element`]) is not to be taken.
    pub element: Option<ElementKind>,
    /// A runner on hexahedra of its own.
    pub solid: Option<Arc<RunnerSolid>>,
}

impl ElasticRunner {
    /// How it gives as a half-space, (1 - nu^2) / E [1/Pa].
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus
    }

    /// A runner held at its flat top.
    pub fn held_at_top(youngs_modulus: f64, poissons_ratio: f64, top: f64) -> Self {
        ElasticRunner {
            youngs_modulus,
            poissons_ratio,
            top,
            mount: Mount::Top,
            flank: None,
            element: None,
            solid: None,
        }
    }

    /// The element of its hexahedra.
    pub fn element_kind(&self) -> ElementKind {
        match self.solid {
            Some(_) => ElementKind::Hex8Incompatible,
            None => self
                .element
                .unwrap_or(self.mount.element(self.poissons_ratio)),
        }
    }
}
