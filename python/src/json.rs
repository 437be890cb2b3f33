//! Conversion of Rust values to Python's dictionaries and lists, through JSON, and to NumPy arrays.

use kufe::jobs::Columns;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::error::bad_input;

/// The value as returned by `json.loads`.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(bad_input)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Columns as arrays by name.
pub fn arrays<'py>(py: Python<'py>, columns: Columns) -> PyResult<Bound<'py, PyDict>> {
    let arrays = PyDict::new(py);
    for (name, values) in columns {
        arrays.set_item(name, PyArray1::from_vec(py, values))?;
    }
    Ok(arrays)
}
