//! Rust values as Python's dictionaries and lists, by way of JSON.

use pyo3::prelude::*;
use serde::Serialize;

use crate::error::bad_input;

/// The value as `json.loads` gives it.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(bad_input)?;
    py.import("json")?.call_method1("loads", (text,))
}
