//! Accuracy and limits of a solve.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::{Error, Iterate, SlidingIterate};

/// Version of the numerics. It rises whenever the same problem and options give other figures, so
/// that stored results of an older version are not reused.
pub const NUMERICS: u32 = 22;

/// Weight of the relative error of the area where the ice's hardness fixes the peak and the mesh is
/// refined for the area.
///
/// The area's error is of first order and scatters with the position of the rim between nodes.
pub(crate) const AREA_WEIGHT: f64 = 0.25;

/// Representation of the stiffness of the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StiffnessForm {
    /// Applied cell by cell, without being stored.
    #[default]
    MatrixFree,
    /// Assembled, one matrix per body. Takes about ten times the memory, and a product several
    /// times the time; the solution is the same up to rounding. The preconditioners are the same.
    Assembled,
}

/// Callback for every update of the contact set.
pub type Watcher = Arc<dyn Fn(&Iterate) + Send + Sync>;

/// A mesh that is about to be solved. Grids on which asperities in contact are searched before the
/// first mesh have its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextMesh {
    /// Number of the mesh, counted from the coarsest.
    pub level: usize,
    /// Number of unknowns.
    pub dofs: usize,
    /// As in [`Iterate::error_before`].
    pub error_before: Option<f64>,
}

/// Callback for every mesh before it is solved.
pub type MeshWatcher = Arc<dyn Fn(&NextMesh) + Send + Sync>;

/// Callback for every correction of a sliding contact.
pub type SlidingWatcher = Arc<dyn Fn(&SlidingIterate) + Send + Sync>;

/// Accuracy and limits of a solve.
#[derive(Clone)]
pub struct Options {
    /// Requested relative discretisation error of the peak pressure.
    pub p_max_tolerance: f64,
    /// Relative energy-norm residual of the equations on each mesh.
    pub residual: f64,
    /// Largest number of unknowns of a mesh, as expected when its resolution is chosen: 1.5^3 times
    /// the number of the previous mesh. The mesh itself may have about a tenth more. The coarsest
    /// mesh is solved whatever its size. A cell of boundary elements counts four times, as their
    /// transforms work on twice the cells along either axis.
    pub max_dofs: usize,
    /// Number of cells over half the patch of a single mesh. If given, this mesh is solved instead
    /// of refining to `p_max_tolerance`, and the reported error is infinite. For contacts of many
    /// asperities, solved by boundary elements, the patch is half the mean size of an asperity.
    pub cells: Option<usize>,
    /// Representation of the stiffness.
    pub stiffness: StiffnessForm,
    /// Largest memory for assembling the stiffness of all bodies of a mesh [bytes].
    pub max_stiffness_bytes: u64,
    /// Whether the shear under the peak pressure is estimated
    /// ([`Solution::under_peak`](crate::Solution::under_peak)). The ice is then always solved in
    /// its volume, never by boundary elements.
    pub subsurface: bool,
    /// Called after every update of the contact set, in order, with the present values.
    pub progress: Option<Watcher>,
    /// Called before each mesh is solved, which may take longer than all meshes before it.
    pub next_mesh: Option<MeshWatcher>,
    /// Called in the solution of sliding: on each mesh with the solution on the contact plane
    /// alone, and after every correction by the bodies.
    pub sliding_progress: Option<SlidingWatcher>,
    /// When set to true, the solve ends with [`Error::Stopped`](crate::Error::Stopped) within about
    /// one iteration.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Options {
    /// Whether the stop flag is set.
    pub(crate) fn stopped(&self) -> bool {
        self.stop
            .as_ref()
            .is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Calls the watcher of meshes before one is solved.
    pub(crate) fn announce(&self, level: usize, dofs: usize, error_before: Option<f64>) {
        if let Some(watcher) = &self.next_mesh {
            watcher(&NextMesh {
                level,
                dofs,
                error_before,
            });
        }
    }

    /// [`Error::Stopped`](crate::Error::Stopped) if the stop flag is set.
    pub(crate) fn check_stop(&self) -> Result<(), Error> {
        if self.stopped() {
            return Err(Error::Stopped);
        }
        Ok(())
    }
}

impl Default for Options {
    /// One per cent of peak pressure, residual 1e-9, at most 4 million unknowns, matrix-free,
    /// assembled in at most 4 GB where requested, silent.
    fn default() -> Self {
        Options {
            p_max_tolerance: 0.01,
            residual: 1e-9,
            max_dofs: 4_000_000,
            cells: None,
            stiffness: StiffnessForm::MatrixFree,
            max_stiffness_bytes: 4_000_000_000,
            subsurface: false,
            progress: None,
            next_mesh: None,
            sliding_progress: None,
            stop: None,
        }
    }
}
