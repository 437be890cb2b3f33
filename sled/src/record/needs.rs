//! What a computation needs of a run; everything else may be absent.

use crate::column::COLUMNS;
use crate::conditions::Conditions;
use crate::error::Error;
use crate::sled::Sled;

/// What a computation needs of a run besides `t_s`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// The computation, as an error names it.
    pub by: &'static str,
    /// Columns of the run's file.
    pub columns: &'static [&'static str],
    /// Whether ice and air push in it: then weather counts.
    pub forces: bool,
}

impl Needs {
    /// Forces on the runners from motion and slip: all but `ax_mps2`. What brakes is compared with
    /// that where it is there.
    pub const FORCES: Needs = Needs {
        by: "the forces on the runners",
        columns: COLUMNS.split_at(1).1,
        forces: true,
    };

    /// The place along a track, by its curvature and bank: from `ay_mps2` to `v_mps`.
    pub const PLACE: Needs = Needs {
        by: "the place along the track, from curvature and bank",
        columns: COLUMNS.split_at(7).0.split_at(1).1,
        forces: false,
    };

    /// The same and `ax_mps2`, for the slope of a track that no survey states.
    pub const TRACK: Needs = Needs {
        by: "a track estimated from its runs",
        columns: COLUMNS.split_at(7).0,
        forces: false,
    };

    /// An error with the name of the computation, where it is of a missing column.
    pub fn explain(&self, mut error: Error) -> Error {
        if let Error::MissingColumn { needed_by, .. } = &mut error {
            *needed_by = Some(self.by);
        }
        error
    }
}

/// Refuses weather that `by` needs for the density of the air and nothing states; `file` is where
/// it belongs.
///
/// # Errors
/// [`Error::File`] with the column.
pub fn refuse_unstated_air(by: &str, conditions: &Conditions, file: &str) -> Result<(), Error> {
    let air = [("air_c", conditions.air_c), ("air_pa", conditions.air_pa)];
    let Some((column, _)) = air.into_iter().find(|(_, value)| value.is_nan()) else {
        return Ok(());
    };
    let reason = format!("{column}, which {by} needs, is not stated; expected it in runs.csv");
    Err(Error::file(file, reason))
}

/// The same for the drag of a sled, which needs none where it has no area.
///
/// # Errors
/// [`Error::File`] with the column.
pub(crate) fn refuse_drag_without_air(
    sled: &Sled,
    conditions: &Conditions,
    file: &str,
) -> Result<(), Error> {
    if sled.cda_m2 == 0.0 {
        return Ok(());
    }
    let by = format!("the drag of sled.cda_m2 = {}", sled.cda_m2);
    refuse_unstated_air(&by, conditions, file)
}
