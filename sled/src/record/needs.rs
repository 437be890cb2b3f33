//! The columns and conditions of a run that a computation needs; others may be absent.

use crate::column::COLUMNS;
use crate::conditions::Conditions;
use crate::error::Error;
use crate::sled::Sled;

/// The columns of a run that a computation needs besides `t_s`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Name of the computation in errors.
    pub by: &'static str,
    /// Columns of the run's file.
    pub columns: &'static [&'static str],
    /// Whether the computation contains forces of ice and air, and so needs the weather.
    pub forces: bool,
}

impl Needs {
    /// Forces on the runners from motion and slip: all but `ax_mps2`, which is compared with the
    /// braking force if it is recorded.
    pub const FORCES: Needs = Needs {
        by: "the forces on the runners",
        columns: COLUMNS.split_at(1).1,
        forces: true,
    };

    /// Distance along a track from its curvature and bank: `ax_mps2` to `v_mps`.
    pub const PLACE: Needs = Needs {
        by: "the place along the track, from curvature and bank",
        columns: COLUMNS.split_at(7).0,
        forces: false,
    };

    /// The error, with the name of the computation if it is of a missing column.
    pub fn explain(&self, mut error: Error) -> Error {
        if let Error::MissingColumn { needed_by, .. } = &mut error {
            *needed_by = Some(self.by);
        }
        error
    }
}

/// Checks the weather that the computation `by` needs for the density of the air.
///
/// # Errors
/// [`Error::File`] with `file` and the absent column.
pub fn refuse_unstated_air(by: &str, conditions: &Conditions, file: &str) -> Result<(), Error> {
    let air = [("air_c", conditions.air_c), ("air_pa", conditions.air_pa)];
    let Some((column, _)) = air.into_iter().find(|(_, value)| value.is_nan()) else {
        return Ok(());
    };
    let reason = format!("{column}, which {by} needs, is not stated; expected it in runs.csv");
    Err(Error::file(file, reason))
}

/// Checks the weather that the drag of a sled needs; a sled without drag area needs none.
///
/// # Errors
/// As [`refuse_unstated_air`].
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
