//! The search for missing effects.

use std::path::PathBuf;

use kufe_discover::{Options, Report};
use pyo3::prelude::*;

use crate::array::{self, Names, names};
use crate::error::InputError;
use crate::json::to_python;
use crate::work::work;

/// Result of a search for effects that are missing in a model.
#[pyclass(frozen, module = "kufe")]
pub struct Discovery {
    report: Report,
    /// The model with the added effects, as TOML; None for a `quick` search.
    #[pyo3(get)]
    next_model: Option<String>,
    /// The next case, as its file's text, where a campaign has pressures and other data; else None.
    #[pyo3(get)]
    next_case: Option<String>,
}

/// Finds where simulation and measurement differ, and names the effect that explains it.
///
/// `data` is a `runs.csv`, an `experiments.csv` or a `pressures.csv`; `model` the `model.toml`, or
/// for pressures the `case.toml`. A `campaign.toml` names several of them and their model itself.
///
/// `only` names the effects to look for, and `"unknown"` for what is outside the catalogue; all
/// where it is absent.
///
/// `quick` fits the base and screens the effects once: nothing is tested on held-out data.
#[allow(clippy::too_many_arguments)] // keywords in Python
#[pyfunction]
#[pyo3(signature = (data, model = None, *, seed = 1, twins = 40, channels = "all", only = None, quick = false, progress = None))]
pub fn discover(
    py: Python<'_>,
    data: PathBuf,
    model: Option<PathBuf>,
    seed: i128,
    twins: i64,
    channels: &str,
    only: Option<Names>,
    quick: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Discovery> {
    if !(10..=1000).contains(&twins) {
        return Err(InputError::new_err(format!(
            "twins {twins}: expected 10 to 1000"
        )));
    }
    if !["all", "lateral", "longitudinal"].contains(&channels) {
        return Err(InputError::new_err(format!(
            "channels {channels:?}: expected all, lateral or longitudinal"
        )));
    }
    let options = Options {
        seed: array::seed(seed)?,
        twins: twins.unsigned_abs(),
        longitudinal: channels != "lateral",
        lateral: channels != "longitudinal",
        only: names(only),
        quick,
        ..Options::default()
    };
    let found = work(py, progress, move |watch, _| {
        kufe_discover::discover(&data, model.as_deref(), &options, &|text| {
            watch.progress(text)
        })
    })?;
    Ok(Discovery {
        report: found.report,
        next_model: found.next_model,
        next_case: found.next_case,
    })
}

#[pymethods]
impl Discovery {
    /// The verdict: named, one-of, law, depends-on, located, not-identifiable,
    /// inadequate or none.
    #[getter]
    fn verdict(&self, py: Python<'_>) -> PyResult<String> {
        to_python(py, &self.report.verdict)?.extract()
    }

    /// The outcome as a sentence.
    #[getter]
    fn sentence(&self) -> &str {
        &self.report.sentence
    }

    /// Content of `report.json`.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.report)
    }

    /// The report as an HTML page.
    #[getter]
    fn html(&self) -> String {
        kufe::report::discovery_page(&self.report, None)
    }

    fn __repr__(&self) -> String {
        format!("<kufe.Discovery {}>", self.report.sentence)
    }
}
