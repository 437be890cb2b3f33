//! Failures as exceptions, with the texts of the command.

use std::io::ErrorKind;

use kufe::jobs::Failure;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::import_exception;
use pyo3::prelude::*;

import_exception!(kufe._errors, FileError);
import_exception!(kufe._errors, InputError);
import_exception!(kufe._errors, MissingFileError);
import_exception!(kufe._errors, NotConvergedError);

/// Converts a failure into an exception.
pub fn raised(failure: Failure) -> PyErr {
    let text = failure.to_string();
    match failure {
        Failure::Usage(_) | Failure::BadInput(_) => bad_input(text),
        Failure::NotConverged(_) => NotConvergedError::new_err(text),
        Failure::Partial(_) => PyKeyboardInterrupt::new_err(text),
    }
}

/// Converts an error of a library into an `InputError`, and into one that is an `OSError` too where
/// its text contains an error of the system: the library writes those as "text (os error number)".
pub fn bad_input(error: impl std::fmt::Display) -> PyErr {
    let text = error.to_string();
    let code = text.split_once("(os error ").and_then(|(_, rest)| {
        let (code, _) = rest.split_once(')')?;
        code.parse().ok()
    });
    let Some(code) = code else {
        return InputError::new_err(text);
    };
    let error = match std::io::Error::from_raw_os_error(code).kind() {
        ErrorKind::NotFound => MissingFileError::new_err(text),
        _ => FileError::new_err(text),
    };
    Python::attach(|py| error.value(py).setattr("errno", code))
        .map_or_else(|raised| raised, |()| error)
}

/// The run of a result whose name, as `name_of` returns it, is `name`.
pub fn named_run<'a, T>(runs: &'a [T], name: &str, name_of: fn(&T) -> &String) -> PyResult<&'a T> {
    runs.iter().find(|run| name_of(run) == name).ok_or_else(|| {
        let known: Vec<&str> = runs.iter().map(|run| name_of(run).as_str()).collect();
        let known = known.join(", ");
        InputError::new_err(format!("run {name}: the runs are {known}"))
    })
}
