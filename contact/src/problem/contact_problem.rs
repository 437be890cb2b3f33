//! What is pressed on what, and how hard.

use std::sync::Arc;

use kufe_mesh::IceSurface;

use crate::{ElasticRunner, Ice, Load, Runner};

/// A runner on ice under a load.
#[derive(Clone)]
pub struct Problem {
    /// The runner.
    pub runner: Runner,
    /// The ice.
    pub ice: Ice,
    /// Height of the unloaded ice over the track; even where absent.
    pub ice_surface: Option<Arc<dyn IceSurface>>,
    /// Curvature of the track in the vertical plane, positive in a valley [1/m].
    pub track_curvature: f64,
    /// The load and what may tilt.
    pub load: Load,
}

impl Problem {
    /// On even ice and a track that is straight in the vertical plane.
    pub fn new(runner: Runner, ice: Ice, load: Load) -> Self {
        Problem {
            runner,
            ice,
            ice_surface: None,
            track_curvature: 0.0,
            load,
        }
    }

    /// How both bodies give as half-spaces, 1 / E* = (1 - nu^2) / E of the ice and, where it is elastic, of the runner [1/Pa].
    pub fn compliance(&self) -> f64 {
        let runner = self.runner.elastic.as_ref();
        self.ice.compliance() + runner.map_or(0.0, ElasticRunner::compliance)
    }
}
