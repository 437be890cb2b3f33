//! Recordings of other programs, and the pages of results.

use std::path::PathBuf;

use kufe::jobs::import::RunImport;
use kufe::report::result_page;
use pyo3::prelude::*;

use crate::folder::write_folder;
use crate::json::to_python;
use crate::work::work;

/// Imports recordings of other programs: `mapping` is the `mapping.toml`. Writes `runs.csv`, one
/// file per run and `import.json` into `folder`, which must be new or empty; all files or none.
///
/// Returns the content of `import.json` as a dictionary; runs that cannot be imported are under
/// `excluded`, with the reason. `strict` refuses them instead.
#[pyfunction]
#[pyo3(signature = (mapping, folder, *, strict = false, progress = None))]
pub fn import_runs<'py>(
    py: Python<'py>,
    mapping: PathBuf,
    folder: PathBuf,
    strict: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let imported = work(py, progress, move |watch, _| {
        let import = RunImport::read(&mapping, strict)?;
        write_folder(&folder, watch, |files| import.write(files, watch))
    })?;
    to_python(py, &imported.list)
}

/// The page of a folder that a command or `Contact.write` has written, or of a lookup table
/// (`.lut`): one HTML text that needs no network.
#[pyfunction]
pub fn report(py: Python<'_>, result: PathBuf) -> PyResult<String> {
    let page = work(py, None, move |_, _| result_page(&result, None))?;
    Ok(page.html)
}
