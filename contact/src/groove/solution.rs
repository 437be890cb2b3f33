//! What steady sliding comes to.

use crate::{GrooveProfile, Solution};

/// A figure with its estimated discretisation error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The figure.
    pub value: f64,
    /// Its error.
    pub error: f64,
}

/// The patch at one place along the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Place along the runner [m].
    pub x: f64,
    /// Width of the contact [m].
    pub width: f64,
    /// Pressure averaged over the width [Pa].
    pub pressure: f64,
}

/// A runner that slides steadily towards +x on ice that yields.
#[derive(Clone, Debug, PartialEq)]
pub struct SlidingSolution {
    /// The contact: pressures, and gaps over the groove.
    pub contact: Solution,
    /// What it leaves in the ice, and where it stands in it.
    pub groove: Groove,
}

/// The groove of a runner that slides: what is left in the ice, the force that it takes, and the patch in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Groove {
    /// Largest plastic depth that the runner leaves, with what was there before [m].
    pub deepest: Measure,
    /// Force against the motion that deepens the groove, F = H A with the area A of the section added, or the sum of pressure times
    /// the runner's slope: the mean of both for a rigid runner, the first for one that bends [N].
    pub ploughing: Measure,
    /// Front end of the patch ahead of the lowest point [m].
    pub front: Measure,
    /// Back end of the patch ahead of the lowest point: negative where it lies behind [m].
    pub back: Measure,
    /// Centre of pressure ahead of the lowest point [m].
    pub load_ahead: Measure,
    /// The lowest point of the runner as it is turned, along x [m].
    pub lowest: f64,
    /// Section that is left.
    pub profile: GrooveProfile,
    /// Plastic depth at the nodes of the contact's surface [m].
    pub depth: Vec<f64>,
    /// The patch from its front to its back.
    pub sections: Vec<Section>,
    /// What happened, mesh by mesh.
    pub meshes: Vec<SlidingMesh>,
}

/// One mesh of a sliding contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingMesh {
    /// Unknowns.
    pub dofs: usize,
    /// Nodes in contact.
    pub contact_nodes: usize,
    /// Corrections of the contact plane's response by the bodies.
    pub corrections: usize,
    /// Conjugate-gradient iterations of all corrections.
    pub iterations: usize,
    /// Sum of the forces' changes in the last correction, over the load.
    pub residual: f64,
    /// Groove's depth on this mesh alone [m].
    pub groove_depth: f64,
    /// Ploughing force on this mesh alone, from the plastic work over the way [N].
    pub plastic_work: f64,
    /// Ploughing force on this mesh alone from pressures and the slope of the undeformed runner [N].
    pub ploughing_by_slope: f64,
}
