//! What meshes say of the largest shear under the peak pressure.

use crate::accuracy::extrapolation::Sequence;
use crate::accuracy::order::Raw;
use crate::{LargestShear, UnderPeak};

/// The largest shear and its depth, mesh by mesh.
pub(crate) struct ShearHistory {
    shear: Sequence,
    depth: Sequence,
}

impl ShearHistory {
    pub fn new() -> Self {
        ShearHistory {
            shear: Sequence::alternating(),
            depth: Sequence::alternating(),
        }
    }

    /// Adds a mesh: finer and similar to the last one, or `graded_anew`. One whose shear is largest at an end of the line says nothing, and those
    /// before it nothing of what follows.
    pub fn push(&mut self, largest: Option<LargestShear>, cells: f64, graded_anew: bool) {
        let Some(LargestShear { value, depth }) = largest else {
            *self = ShearHistory::new();
            return;
        };
        self.shear.push(Raw { cells, value }, graded_anew);
        let value = depth;
        self.depth.push(Raw { cells, value }, graded_anew);
    }

    /// The limit of the shear, and the last mesh's depth, with their errors; both have besides what stays of these relative errors on all meshes,
    /// independent of theirs and of one sign. `None` where the last mesh says nothing.
    pub fn under_peak(&self, left: f64, missed: f64) -> Option<UnderPeak> {
        let depth = self.depth.value();
        if depth.is_nan() {
            return None;
        }
        let shear = self.shear.last();
        let with = |error: f64, value: f64| error.hypot(left * value) + missed * value;
        Some(UnderPeak {
            shear: shear.value,
            shear_error: with(shear.error, shear.value),
            depth,
            depth_error: with(self.depth.last().error_of(depth), depth),
        })
    }
}
