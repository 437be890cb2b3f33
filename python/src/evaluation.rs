//! Evaluation of drivers.

use std::path::PathBuf;

use kufe::jobs::{Failure, lateral::warn_of_slip_offsets, runs::RunSelection};
use kufe::results::Evaluation as EvaluationDocument;
use kufe_sled::DrivingForce;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{self, Names, names};
use crate::error::named_run;
use crate::json::{arrays, to_python};
use crate::work::work_with_warnings;

/// The value of a column at an instant.
type Column = fn(&DrivingForce) -> f64;

/// Losses of drivers compared with a straight glide.
#[pyclass(frozen, module = "kufe")]
pub struct Evaluation {
    document: EvaluationDocument,
    /// Remarks on the runs.
    #[pyo3(get)]
    remarks: Vec<String>,
}

/// Evaluates recorded runs: `runs` is the index `runs.csv`, `model` the `model.toml`.
#[pyfunction]
#[pyo3(signature = (
    runs,
    model,
    *,
    session = None,
    track = None,
    leave_out_bad_runs = false,
    strict = false,
    cutoff_hz = 20.0,
    seed = 1,
    progress = None,
))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn evaluate(
    py: Python<'_>,
    runs: PathBuf,
    model: PathBuf,
    session: Option<Names>,
    track: Option<Names>,
    leave_out_bad_runs: bool,
    strict: bool,
    cutoff_hz: f64,
    seed: i128,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Evaluation> {
    let seed = array::seed(seed)?;
    let selection = RunSelection {
        runs,
        model,
        session: names(session),
        track: names(track),
        leave_out_bad_runs,
        strict,
        cutoff_hz,
    };
    let (document, remarks) = work_with_warnings(py, progress, move |watch, _| {
        let loaded = selection.load(watch, |_| true)?;
        warn_of_slip_offsets(&loaded, watch);
        let runs = kufe_sled::evaluate(&loaded.prepared, &loaded.vehicle);
        Ok::<_, Failure>(EvaluationDocument::new(runs, loaded.used, seed))
    })?;
    Ok(Evaluation { document, remarks })
}

#[pymethods]
impl Evaluation {
    /// One dictionary per run, as in `evaluation.json`.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.runs)
    }

    /// Means by driver and by track, each with its 95 % interval over runs, as in
    /// `evaluation.json`.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.groups)
    }

    /// The time that each driver loses on each track, `lost_s`, and along it, `stretches`; one
    /// dictionary a driver and track.
    #[getter]
    fn drivers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.drivers)
    }

    /// Content of `evaluation.json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document)
    }

    /// Excluded runs, with the reason.
    #[getter]
    fn left_out(&self) -> Vec<String> {
        self.document.used.left_out.clone()
    }

    /// One run's samples as arrays: time, place, force along the motion as driven and of a straight
    /// glide, angles.
    fn series<'py>(&self, py: Python<'py>, run: &str) -> PyResult<Bound<'py, PyDict>> {
        let found = named_run(&self.document.runs, run, |run| &run.run)?;
        let columns: [(&str, Column); 8] = [
            ("t_s", |sample| sample.t_s),
            ("s_m", |sample| sample.s_m),
            ("actual_n", |sample| sample.actual_n),
            ("ideal_n", |sample| sample.ideal_n),
            ("alpha_f_rad", |sample| sample.alpha_f_rad),
            ("alpha_r_rad", |sample| sample.alpha_r_rad),
            ("delta_rad", |sample| sample.delta_rad),
            ("beta_rad", |sample| sample.beta_rad),
        ];
        let values = |of: Column| found.series.iter().map(of).collect();
        arrays(py, columns.map(|(name, of)| (name, values(of))).into())
    }

    fn __repr__(&self) -> String {
        format!("<kufe.Evaluation of {} runs>", self.document.runs.len())
    }
}
