//! Lateral friction: fits to recorded runs, and comparison with runs.

use std::path::PathBuf;

use kufe::jobs::force_columns;
use kufe::jobs::lateral::{FittedLaws, fit_lateral, validate_runs};
use kufe::jobs::runs::RunSelection;
use kufe::results::{LateralFitDocument, Validation as ValidationDocument};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Names, names};
use crate::error::{named_run, raised};
use crate::json::{arrays, to_python};
use crate::work::work_with_warnings;

/// Lateral friction of both runners, fitted to recorded runs.
#[pyclass(frozen, module = "kufe")]
pub struct Fit {
    document: LateralFitDocument,
    /// The model with the fitted laws: TOML that every command accepts.
    #[pyo3(get)]
    model: String,
    /// Remarks on the runs.
    #[pyo3(get)]
    remarks: Vec<String>,
}

/// Fits the lateral friction of both runners to recorded runs: `runs` is the index `runs.csv`,
/// `model` the `model.toml`.
///
/// `keep_contacts` retains samples with an external force, such as that of a wall. The other
/// keywords select the runs, as those of `evaluate`.
#[pyfunction]
#[pyo3(signature = (
    runs,
    model,
    *,
    keep_contacts = false,
    session = None,
    track = None,
    leave_out_bad_runs = false,
    strict = false,
    cutoff_hz = 20.0,
    progress = None,
))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn fit(
    py: Python<'_>,
    runs: PathBuf,
    model: PathBuf,
    keep_contacts: bool,
    session: Option<Names>,
    track: Option<Names>,
    leave_out_bad_runs: bool,
    strict: bool,
    cutoff_hz: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Fit> {
    let selection = RunSelection {
        runs,
        model,
        session: names(session),
        track: names(track),
        leave_out_bad_runs,
        strict,
        cutoff_hz,
    };
    let (fitted, remarks) = work_with_warnings(py, progress, move |watch, _| {
        fit_lateral(&selection, !keep_contacts, watch)
    })?;
    Ok(Fit {
        document: fitted.document,
        model: fitted.model,
        remarks,
    })
}

#[pymethods]
impl Fit {
    /// The front runner's law: each parameter with `value`, `low` and `high`, as in `fit.json`.
    #[getter]
    fn front<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.fit.front)
    }

    /// The rear runner's law.
    #[getter]
    fn rear<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.fit.rear)
    }

    /// Content of `fit.json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document)
    }

    fn __repr__(&self) -> String {
        let fit = &self.document.fit;
        format!(
            "<kufe.Fit of {} runs, {} samples>",
            fit.runs.len(),
            fit.samples
        )
    }
}

/// Lateral forces of a model compared with those of recorded runs.
#[pyclass(frozen, module = "kufe")]
pub struct Validation {
    document: ValidationDocument,
    /// Remarks on the runs.
    #[pyo3(get)]
    remarks: Vec<String>,
}

/// Compares the lateral forces of a model with recorded runs: `runs` is the index `runs.csv`,
/// `model` the `model.toml`.
///
/// The laws of `fit`, a `Fit` or the path of a `fit.json`, replace the model's, and the runs of the
/// fit are excluded. The other keywords select the runs, as those of `evaluate`.
#[pyfunction]
#[pyo3(signature = (
    runs,
    model,
    *,
    fit = None,
    session = None,
    track = None,
    leave_out_bad_runs = false,
    strict = false,
    cutoff_hz = 20.0,
    progress = None,
))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn validate(
    py: Python<'_>,
    runs: PathBuf,
    model: PathBuf,
    fit: Option<&Bound<'_, PyAny>>,
    session: Option<Names>,
    track: Option<Names>,
    leave_out_bad_runs: bool,
    strict: bool,
    cutoff_hz: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Validation> {
    let laws = match fit {
        None => None,
        Some(fit) => Some(match fit.cast::<Fit>() {
            Ok(fit) => FittedLaws::of(&fit.get().document).map_err(raised)?,
            Err(_) => FittedLaws::read(&fit.extract::<PathBuf>()?).map_err(raised)?,
        }),
    };
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
        validate_runs(&selection, laws.as_ref(), watch)
    })?;
    Ok(Validation { document, remarks })
}

#[pymethods]
impl Validation {
    /// One dictionary per run, as in `validation.json`: `rmse_n` is the root mean square difference
    /// of the lateral force [N].
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.runs)
    }

    /// One dictionary per track, with the errors over its runs.
    #[getter]
    fn tracks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document.tracks)
    }

    /// Content of `validation.json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.document)
    }

    /// One run's samples as arrays: time [s], place [m], and the lateral force at the centre of
    /// gravity [N] as measured, of the model, and of Braghin's law.
    fn series<'py>(&self, py: Python<'py>, run: &str) -> PyResult<Bound<'py, PyDict>> {
        let found = named_run(&self.document.runs, run, |run| &run.run)?;
        arrays(py, force_columns(found))
    }

    fn __repr__(&self) -> String {
        format!("<kufe.Validation of {} runs>", self.document.runs.len())
    }
}
