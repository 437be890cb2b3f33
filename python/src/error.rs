//! Failures as exceptions, with the texts of the command.

use kufe::jobs::Failure;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::{PyErr, PyResult, import_exception};

import_exception!(kufe._errors, InputError);
import_exception!(kufe._errors, NotConvergedError);

/// Converts a failure into an exception.
pub fn raised(failure: Failure) -> PyErr {
    let text = failure.to_string();
    match failure {
        Failure::Usage(_) | Failure::BadInput(_) => InputError::new_err(text),
        Failure::NotConverged(_) => NotConvergedError::new_err(text),
        Failure::Partial(_) => PyKeyboardInterrupt::new_err(text),
    }
}

/// Converts an error of a library into an `InputError`.
pub fn bad_input(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}

/// The run of a result whose name, as `name_of` returns it, is `name`.
pub fn named_run<'a, T>(runs: &'a [T], name: &str, name_of: fn(&T) -> &String) -> PyResult<&'a T> {
    runs.iter().find(|run| name_of(run) == name).ok_or_else(|| {
        let known: Vec<&str> = runs.iter().map(|run| name_of(run).as_str()).collect();
        let known = known.join(", ");
        InputError::new_err(format!("run {name}: the runs are {known}"))
    })
}
