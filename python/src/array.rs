//! Arguments that are numbers, lists or names, as NumPy's users pass them.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::InputError;

/// Numbers of any kind as an array; masked ones are NaN.
pub fn numbers<'py>(given: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let masked = given.py().import("numpy.ma")?;
    let array = masked.call_method1("asarray", (given, "float64", "C"))?;
    array.call_method1("filled", (f64::NAN,))?.extract()
}

/// Whole numbers as an array; masked ones are -1.
pub fn integers<'py>(
    given: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let masked = given.py().import("numpy.ma")?;
    let array = masked.call_method1("asarray", (given,))?;
    let kind = array.getattr("dtype")?;
    let empty = array.getattr("size")?.extract::<usize>()? == 0;
    if !empty && !["i", "u"].contains(&kind.getattr("kind")?.extract()?) {
        let text = format!("{name}: found numbers of type {kind}, expected integers");
        return Err(PyTypeError::new_err(text));
    }
    let array = array.call_method1("astype", ("int64",))?;
    array.call_method1("filled", (-1,))?.extract()
}

/// One number, or a list of them.
pub fn list(given: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let array = numbers(given)?;
    if array.ndim() > 1 {
        let shape = array.shape();
        let text = format!("{name}: found an array of shape {shape:?}, expected a list of numbers");
        return Err(InputError::new_err(text));
    }
    Ok(array.as_array().iter().copied().collect())
}

/// One name, or a list of them.
#[derive(FromPyObject)]
pub enum Names {
    /// One name.
    One(String),
    /// A list of names.
    Several(Vec<String>),
}

/// The names; none where nothing is given.
pub fn names(given: Option<Names>) -> Vec<String> {
    match given {
        None => Vec::new(),
        Some(Names::One(name)) => vec![name],
        Some(Names::Several(names)) => names,
    }
}

/// A seed of random numbers.
pub fn seed(given: i128) -> PyResult<u64> {
    u64::try_from(given).map_err(|_| {
        let text = format!("seed = {given}: expected 0 to {}", u64::MAX);
        InputError::new_err(text)
    })
}
