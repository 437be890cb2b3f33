//! Reading runs from their index.

use std::path::Path;

use kufe_sled::{Model, Needs, OnGaps, Run, read_runs, refuse_unstated_air};

use crate::error::Error;
use crate::evidence::runs::recordings::prepare::{Data, prepare};
use crate::evidence::runs::recordings::survey::TrackTables;
use crate::options::Options;

/// Columns that every search needs.
const REQUIRED: Needs = Needs {
    by: "a search",
    columns: &[
        "ay_mps2",
        "yaw_rate_radps",
        "v_mps",
        "alpha_rad",
        "delta_rad",
    ],
    forces: true,
};

/// Reads an index and its runs, holds out a part of them and prepares them.
///
/// A column other than the required ones may be missing; effects that need it are then not
/// testable.
///
/// # Errors
/// Errors of the sled's readers; [`Error::Duplicate`] if two runs have the same samples;
/// [`Error::TooFew`].
pub fn read(index: &Path, model: &Model, options: &Options) -> Result<Data, Error> {
    let on_gaps = if options.strict {
        OnGaps::Refuse
    } else {
        OnGaps::LeaveOut
    };
    let runs = read_runs(index, &REQUIRED, on_gaps)?;
    for Run { entry, .. } in &runs {
        let file = entry.file.display().to_string();
        refuse_unstated_air(REQUIRED.by, &entry.conditions, &file)?;
    }
    refuse_copies(index, &runs)?;
    let folder = index.parent().unwrap_or(Path::new(""));
    let tables = TrackTables::in_folder(folder, &runs)?;
    let mut data = prepare(&runs, model, &tables.slopes, &options.rules)?;
    data.tracks = tables.whole;
    Ok(data)
}

/// Refuses two runs with the same samples.
fn refuse_copies(index: &Path, runs: &[Run]) -> Result<(), Error> {
    for (i, run) in runs.iter().enumerate() {
        if let Some(copy) = runs[..i].iter().find(|other| same_samples(other, run)) {
            return Err(Error::Duplicate {
                file: index.display().to_string(),
                first: format!("run {}", copy.entry.run),
                second: format!("run {}", run.entry.run),
            });
        }
    }
    Ok(())
}

/// A renamed or cut copy shares its lateral acceleration sample by sample.
fn same_samples(a: &Run, b: &Run) -> bool {
    let (Some(x), Some(y)) = (a.columns.get("ay_mps2"), b.columns.get("ay_mps2")) else {
        return false;
    };
    let n = x.len().min(y.len()).min(400);
    let varies = x[..n].iter().any(|value| *value != x[0]);
    varies && x[..n] == y[..n]
}
