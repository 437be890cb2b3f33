//! How accurate a solve is to be, and what it may cost.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::{Error, Iterate, SlidingIterate};

/// Version of the numerics: it rises whenever the same problem and options give other figures, so
/// that results stored by an older version are not taken for this one's.
pub const NUMERICS: u32 = 22;

/// Weight of the relative error of the area where the ice's hardness fixes the peak and the area is
/// what is refined.
///
/// The area's error is of first order and scatters with the place of the rim between nodes.
pub(crate) const AREA_WEIGHT: f64 = 0.25;

/// The form in which the stiffness of the bodies is multiplied with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StiffnessForm {
    /// Applied cell by cell, without being stored.
    #[default]
    MatrixFree,
    /// Assembled, one matrix a body: some ten times the memory and several times the time of a
    /// product, the same answer to rounding. The preconditioners are the same.
    Assembled,
}

/// Callback for every update of the contact set.
pub type Watcher = Arc<dyn Fn(&Iterate) + Send + Sync>;

/// A mesh that is about to be solved. Grids on which asperities in contact are searched before the
/// first mesh have its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextMesh {
    /// Its number, counted from the coarsest.
    pub level: usize,
    /// Its unknowns.
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
    /// Largest number of unknowns that a mesh is expected to have when its resolution is chosen:
    /// 1.5^3 times those of the last one. The mesh itself may have about a tenth more, and the
    /// coarsest one is solved whatever it has. A cell of boundary elements counts four times, as
    /// their transforms work on twice the cells along either axis.
    pub max_dofs: usize,
    /// Where given, one mesh with this many cells over half the patch is solved instead of refining
    /// to `p_max_tolerance`; the reported error is then infinite. Of many asperities on uneven ice,
    /// solved by boundary elements, the patch is that of one: half of their mean size.
    pub cells: Option<usize>,
    /// The form of the stiffness.
    pub stiffness: StiffnessForm,
    /// Memory that assembled stiffness may take while it is made, all bodies of a mesh together
    /// [bytes].
    pub max_stiffness_bytes: u64,
    /// Whether the shear under the peak pressure is followed over the meshes:
    /// [`Solution::under_peak`](crate::Solution::under_peak). The ice is solved in its volume then,
    /// whatever it touches.
    pub subsurface: bool,
    /// Called after every update of the contact set, as it happens and in order, with the values of
    /// that moment.
    pub progress: Option<Watcher>,
    /// Called before each mesh is solved, which may take longer than all before it.
    pub next_mesh: Option<MeshWatcher>,
    /// Called while a runner slides: on each mesh with what the contact plane alone makes of it,
    /// and after every correction by the bodies.
    pub sliding_progress: Option<SlidingWatcher>,
    /// Once true, the solve ends with [`Error::Stopped`](crate::Error::Stopped), within about an
    /// iteration.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Options {
    /// Whether the solve is to end.
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

    /// An error where the solve is to end.
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
