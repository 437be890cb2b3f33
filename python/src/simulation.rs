//! Simulated runs.

use std::path::PathBuf;
use std::sync::Arc;

use kufe::jobs::run_columns;
use kufe::jobs::runs::{run_format, write_runs, write_track};
use kufe::jobs::simulate::{NamedDriver, SimulatedDrives, stated_conditions};
use kufe::results::Simulation as SimulationDocument;
use kufe_sled::{Run, SimulateOptions, Track};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array;
use crate::error::{InputError, named_run, raised};
use crate::folder::write_folder;
use crate::json::{arrays, to_python};
use crate::work::{work, work_with_warnings};

/// Simulated runs of one driver on one track.
#[pyclass(frozen, module = "kufe")]
pub struct Simulation {
    runs: Arc<Vec<Run>>,
    track: Arc<Track>,
    document: SimulationDocument,
    /// Remarks on the runs.
    #[pyo3(get)]
    remarks: Vec<String>,
}

/// Drives a sled down a track and records it like a measured run: `model` is the `model.toml`,
/// `track` the table of the track.
///
/// `driver` names one of the sample data (A1, A2, A3, B1, C1), else the driver has the `skill` from
/// 0 to 1. Each run adds its number to `seed`. Units: `start_speed_mps` [m/s], `rate_hz` of the
/// output [Hz], `step_s` of the integration and `most_s`, the longest time [s], `ice_c` and `air_c`
/// [C], `air_pa` [Pa], `humidity_pct` [%], `distance_m` run with this surface finish before [m].
#[pyfunction]
#[pyo3(signature = (
    model,
    track,
    *,
    runs = 1,
    driver = None,
    skill = 0.9,
    seed = 1,
    noise = true,
    start_speed_mps = 10.0,
    rate_hz = 500.0,
    step_s = 0.001,
    most_s = 600.0,
    ice_c = -8.0,
    air_c = 0.0,
    air_pa = 95000.0,
    humidity_pct = None,
    distance_m = None,
    session = "1",
    progress = None,
), text_signature = "(model, track, *, runs=1, driver=None, skill=0.9, seed=1, noise=True, start_speed_mps=10.0, rate_hz=500.0, step_s=0.001, most_s=600.0, ice_c=-8.0, air_c=0.0, air_pa=95000.0, humidity_pct=None, distance_m=None, session='1', progress=None)")]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn simulate(
    py: Python<'_>,
    model: PathBuf,
    track: PathBuf,
    runs: i64,
    driver: Option<&str>,
    skill: f64,
    seed: i128,
    noise: bool,
    start_speed_mps: f64,
    rate_hz: f64,
    step_s: f64,
    most_s: f64,
    ice_c: f64,
    air_c: f64,
    air_pa: f64,
    humidity_pct: Option<f64>,
    distance_m: Option<f64>,
    session: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Simulation> {
    if !(1..=10_000).contains(&runs) {
        let text = format!("runs = {runs}: expected 1 to 10000");
        return Err(InputError::new_err(text));
    }
    let [ice_c, air_c, air_pa] = [ice_c, air_c, air_pa].map(Some);
    let stated = [ice_c, air_c, air_pa, humidity_pct, distance_m, None];
    let drives = SimulatedDrives {
        model,
        track,
        driver: NamedDriver::of(driver, skill).map_err(raised)?,
        runs: runs as u32,
        session: session.to_owned(),
        noise,
        options: SimulateOptions {
            step_s,
            rate_hz,
            start_speed_mps,
            most_s,
            conditions: stated_conditions(stated).map_err(raised)?,
            seed: array::seed(seed)?,
            ..SimulateOptions::default()
        },
    };
    let (driven, remarks) = work_with_warnings(py, progress, move |watch, _| drives.drive(watch))?;
    Ok(Simulation {
        runs: Arc::new(driven.runs),
        track: Arc::new(driven.track),
        document: driven.document,
        remarks,
    })
}

#[pymethods]
impl Simulation {
    /// One dictionary per run, as in `simulation.json`: `run`, `time_s` [s], `finished`, energies
    /// [J].
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.runs)
    }

    /// Content of `simulation.json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document)
    }

    /// One run's channels as arrays, `t_s` among them; each name ends in its unit.
    fn series<'py>(&self, py: Python<'py>, run: &str) -> PyResult<Bound<'py, PyDict>> {
        let run = named_run(&self.runs, run, |run| &run.entry.run)?;
        arrays(py, run_columns(run))
    }

    /// Writes `runs.csv`, one file a run and the table of the track into `folder`, which must be
    /// new or empty; all files or none. `parquet` writes Parquet instead of CSV.
    #[pyo3(signature = (folder, *, parquet = false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, parquet: bool) -> PyResult<()> {
        let (runs, track) = (self.runs.to_vec(), self.track.clone());
        write(py, folder, runs, track, parquet)
    }

    fn __repr__(&self) -> String {
        let (runs, track) = (self.runs.len(), &self.document.track);
        format!("<kufe.Simulation of {runs} runs on {track}>")
    }
}

/// Writes runs, their index and the table of their track into a folder that is new or empty.
pub fn write(
    py: Python<'_>,
    folder: PathBuf,
    mut runs: Vec<Run>,
    track: Arc<Track>,
    parquet: bool,
) -> PyResult<()> {
    work(py, None, move |watch, _| {
        write_folder(&folder, watch, |files| {
            write_runs(files, &mut runs, run_format(parquet))?;
            write_track(files, &track)
        })
    })
}
