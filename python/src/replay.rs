//! Replays of measured runs.

use std::path::PathBuf;
use std::sync::Arc;

use kufe::jobs::replay::{ReplayedDrive, entry_on_track};
use kufe::jobs::{Failure, run_columns};
use kufe_sled::{Run, SimulateOptions, Track};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::json::{arrays, to_python};
use crate::simulation::write;
use crate::work::work_with_warnings;

/// Replay of a measured run by the model, compared with the measurement.
#[pyclass(frozen, module = "kufe")]
pub struct Replay {
    driven: Run,
    track: Arc<Track>,
    document: Value,
    /// Remarks on the run.
    #[pyo3(get)]
    remarks: Vec<String>,
}

/// Drives the model with the start and the steering of a measured run and compares both: `model` is
/// the `model.toml`, `track` the table of the track, `runs` the index `runs.csv`, and `run` the name
/// of the run in it.
///
/// `strict` refuses a run with gaps instead of excluding the samples next to them. Units: `rate_hz`
/// of the output [Hz], `step_s` of the integration and `most_s`, the longest time [s].
#[pyfunction]
#[pyo3(signature = (
    model,
    track,
    runs,
    *,
    run,
    strict = false,
    rate_hz = 500.0,
    step_s = 0.001,
    most_s = 600.0,
    progress = None,
))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn replay(
    py: Python<'_>,
    model: PathBuf,
    track: PathBuf,
    runs: PathBuf,
    run: String,
    strict: bool,
    rate_hz: f64,
    step_s: f64,
    most_s: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Replay> {
    let options = SimulateOptions {
        step_s,
        rate_hz,
        most_s,
        ..SimulateOptions::default()
    };
    let (done, remarks) = work_with_warnings(py, progress, move |watch, _| {
        let track = Track::load(&track)?;
        let drive = ReplayedDrive {
            model,
            entry: entry_on_track(&runs, &run, &track)?,
            track,
            strict,
            options,
        };
        let replayed = drive.drive(watch)?;
        let document = serde_json::to_value(replayed.document())?;
        Ok::<_, Failure>((replayed.driven, drive.track, document))
    })?;
    let (driven, track, document) = done;
    Ok(Replay {
        driven,
        track: Arc::new(track),
        document,
        remarks,
    })
}

#[pymethods]
impl Replay {
    /// Differences of run and model, one dictionary per column: `rms`, `end`, `largest` in the
    /// column's unit, measured minus model.
    #[getter]
    fn differences<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document["replay"]["differences"])
    }

    /// Sections where they differ, one dictionary per section: `from_m`, `to_m` [m], and `lost_s`,
    /// the time that the run loses there [s].
    #[getter]
    fn sections<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document["replay"]["sections"])
    }

    /// Content of `simulation.json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document)
    }

    /// The model's channels as arrays, `t_s` among them, and what was measured at the same places:
    /// `v_measured_mps` and the like, NaN where nothing was.
    fn series<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays(py, run_columns(&self.driven))
    }

    /// Writes `runs.csv`, the run and the table of the track into `folder`, which must be new or
    /// empty; all files or none. `parquet` writes Parquet instead of CSV.
    #[pyo3(signature = (folder, *, parquet = false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, parquet: bool) -> PyResult<()> {
        let (runs, track) = (vec![self.driven.clone()], self.track.clone());
        write(py, folder, runs, track, parquet)
    }

    fn __repr__(&self) -> String {
        let (run, track) = (&self.driven.entry.run, &self.track.name);
        format!("<kufe.Replay of {run} on {track}>")
    }
}
