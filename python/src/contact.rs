//! Cases and their solutions.

use std::path::PathBuf;
use std::sync::Arc;

use kufe::jobs::field::write_contact;
use kufe::jobs::{SolvedContact, case_file::LoadedCase, with_progress};
use kufe_contact::Options;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt};

use crate::error::{InputError, bad_input, raised};
use crate::folder::write_folder;
use crate::hull::Hull;
use crate::json::to_python;
use crate::work::work;

/// One contact problem: runner, ice, track and load.
#[pyclass(frozen, module = "kufe")]
pub struct Case {
    /// The case with what it names.
    pub loaded: LoadedCase,
}

#[pymethods]
impl Case {
    /// A case from TOML; a hull's path starts from `folder`. `hull` stands for the file that
    /// `runner.hull` names, and `name`
    /// for the case in messages.
    #[new]
    #[pyo3(signature = (text, folder = PathBuf::new(), *, name = "the case", hull = None))]
    fn new(
        text: &str,
        folder: PathBuf,
        name: &str,
        hull: Option<&Bound<'_, Hull>>,
    ) -> PyResult<Case> {
        let mut loaded = LoadedCase::parse(name, &folder, text).map_err(raised)?;
        loaded.hull = hull.map(|hull| hull.get().shared());
        Ok(Case { loaded })
    }

    /// A hull on the ice of the example under 1 kN, with other values by dotted key:
    /// `Case.of(hull, {"load.fz_n": 2000.0})`.
    #[staticmethod]
    #[pyo3(signature = (hull, values = None))]
    fn of(hull: &Bound<'_, Hull>, values: Option<&Bound<'_, PyDict>>) -> PyResult<Case> {
        let mut loaded = LoadedCase::example().map_err(raised)?;
        "the hull".clone_into(&mut loaded.name);
        loaded.case.runner.shape = None;
        loaded.case.runner.hull = Some("an array".into());
        loaded.hull = Some(hull.get().shared());
        let case = Case { loaded };
        match values {
            Some(values) => case.replace(values),
            None => Ok(case),
        }
    }

    /// A case from its file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Case> {
        let loaded = LoadedCase::read(&path).map_err(raised)?;
        Ok(Case { loaded })
    }

    /// The case that the command solves where none is given: a bobsled runner on flat ice under 1
    /// kN.
    #[staticmethod]
    fn example() -> PyResult<Case> {
        let loaded = LoadedCase::example().map_err(raised)?;
        Ok(Case { loaded })
    }

    /// The case with other values, by dotted key: `case.replace({"load.fz_n": 2000.0})`.
    fn replace(&self, values: &Bound<'_, PyDict>) -> PyResult<Case> {
        let mut table = toml::Table::try_from(&self.loaded.case).map_err(bad_input)?;
        for (key, value) in values {
            let key: String = key.extract()?;
            set(&mut table, &key, toml_value(&key, &value)?)?;
        }
        Ok(Case {
            loaded: parsed(&self.loaded, &table)?,
        })
    }

    /// The case as TOML.
    fn to_toml(&self) -> PyResult<String> {
        self.loaded.case.to_toml().map_err(bad_input)
    }

    /// What messages call it: its file.
    #[getter]
    fn name(&self) -> &str {
        &self.loaded.name
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((String, PathBuf), Bound<'py, PyDict>)> {
        let keywords = PyDict::new(py);
        keywords.set_item("name", self.name())?;
        let hull = self.loaded.hull.as_deref().cloned();
        let hull = hull.map(Hull::checked).transpose().map_err(bad_input)?;
        keywords.set_item("hull", hull)?;
        Ok(((self.to_toml()?, self.loaded.base.clone()), keywords))
    }

    fn __repr__(&self) -> String {
        format!("<kufe.Case {}>", self.loaded.name)
    }
}

/// The same case with this content.
fn parsed(loaded: &LoadedCase, table: &toml::Table) -> PyResult<LoadedCase> {
    let text = toml::to_string(table).map_err(bad_input)?;
    let mut other = LoadedCase::parse(&loaded.name, &loaded.base, &text).map_err(raised)?;
    other.hull.clone_from(&loaded.hull);
    Ok(other)
}

fn toml_value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if value.is_instance_of::<PyBool>() {
        Ok(toml::Value::Boolean(value.extract()?))
    } else if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() {
        Ok(toml::Value::Float(value.extract()?))
    } else if let Ok(text) = value.extract::<String>() {
        Ok(toml::Value::String(text))
    } else if let Ok(number) = value.extract::<f64>() {
        // NumPy's scalars.
        Ok(toml::Value::Float(number))
    } else {
        Err(InputError::new_err(format!(
            "{key}: found {}, expected a number, a truth value or a text",
            value.get_type().name()?
        )))
    }
}

fn set(table: &mut toml::Table, key: &str, value: toml::Value) -> PyResult<()> {
    let (mut table, mut last) = (table, key);
    while let Some((first, rest)) = last.split_once('.') {
        let inner = table
            .entry(first)
            .or_insert_with(|| toml::Table::new().into());
        table = inner.as_table_mut().ok_or_else(|| {
            InputError::new_err(format!("{key}: {first} is a value, expected a table"))
        })?;
        last = rest;
    }
    table.insert(last.to_owned(), value);
    Ok(())
}

/// A solved case.
#[pyclass(frozen, module = "kufe")]
pub struct Contact {
    pressed: Arc<SolvedContact>,
}

/// Solves one contact problem.
///
/// `case` is a `Case`, the path of one, or a `Hull`, which is pressed on the ice of the example
/// under 1 kN; `accuracy` replaces its `accuracy.p_max`, the requested relative discretisation
/// error of the peak pressure; `subsurface` follows the shear under the peak; `progress` is called
/// with a text on every update of the contact set.
#[pyfunction]
#[pyo3(signature = (case, *, accuracy = None, subsurface = false, progress = None))]
pub fn press(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    accuracy: Option<f64>,
    subsurface: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Contact> {
    let keys: Vec<(&str, toml::Value)> = accuracy.map(accuracy_key).into_iter().collect();
    let options = Options {
        subsurface,
        ..Options::default()
    };
    solved(py, replaced(case, &keys)?, options, progress)
}

/// Solves steady sliding on ice that yields: the groove that the runner ploughs and the melt film
/// in it.
///
/// As `press` on a case with `sliding.v_mps` and `sliding.ice_c`; what else `[sliding]` says is the
/// case's. `result` holds the coefficient of friction with its parts, `groove_m` the plastic depth
/// of the ice.
#[pyfunction]
#[pyo3(signature = (case, v_mps, ice_c, *, accuracy = None, progress = None))]
pub fn slide(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    v_mps: f64,
    ice_c: f64,
    accuracy: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Contact> {
    let mut keys = vec![
        ("sliding.v_mps", v_mps.into()),
        ("sliding.ice_c", ice_c.into()),
    ];
    keys.extend(accuracy.map(accuracy_key));
    solved(py, replaced(case, &keys)?, Options::default(), progress)
}

fn accuracy_key(accuracy: f64) -> (&'static str, toml::Value) {
    ("accuracy.p_max", accuracy.into())
}

/// A case: a `Case`, a `Hull` on the ice of the example, or that at a path.
pub fn loaded_case(case: &Bound<'_, PyAny>) -> PyResult<LoadedCase> {
    if let Ok(case) = case.cast::<Case>() {
        Ok(case.get().loaded.clone())
    } else if let Ok(hull) = case.cast::<Hull>() {
        Ok(Case::of(hull, None)?.loaded)
    } else {
        LoadedCase::read(&case.extract::<PathBuf>()?).map_err(raised)
    }
}

/// The case with these keys replaced.
fn replaced(case: &Bound<'_, PyAny>, keys: &[(&str, toml::Value)]) -> PyResult<LoadedCase> {
    let loaded = loaded_case(case)?;
    if keys.is_empty() {
        return Ok(loaded);
    }
    let mut table = toml::Table::try_from(&loaded.case).map_err(bad_input)?;
    for (key, value) in keys {
        set(&mut table, key, value.clone())?;
    }
    parsed(&loaded, &table)
}

fn solved(
    py: Python<'_>,
    loaded: LoadedCase,
    options: Options,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Contact> {
    let watched = progress.is_some();
    let worked = work(py, progress, move |watch, teller| {
        let options = Options {
            stop: Some(teller.stop.clone()),
            ..options
        };
        let options = match watched {
            true => with_progress(options, &loaded.case, move |line| teller.progress(line)),
            false => options,
        };
        kufe::Contact::from(loaded).options(options).best(watch)
    })?;
    let pressed = worked.value.map_err(raised)?;
    let short = pressed.short.clone();
    let pressed = Arc::new(pressed);
    let contact = Contact { pressed };
    match short {
        None => Ok(contact),
        Some(failure) => {
            let error = raised(failure);
            error.value(py).setattr("best", contact)?;
            Err(error)
        }
    }
}

#[pymethods]
impl Contact {
    /// Peak pressure [Pa].
    #[getter]
    fn p_max_pa(&self) -> f64 {
        self.pressed.solution.p_max
    }

    /// Estimated discretisation error of the peak pressure [Pa].
    #[getter]
    fn p_max_error_pa(&self) -> f64 {
        self.pressed.solution.p_max_error
    }

    /// Force over contact area [Pa].
    #[getter]
    fn p_mean_pa(&self) -> f64 {
        self.pressed.solution.p_mean
    }

    /// Error of the mean pressure [Pa].
    #[getter]
    fn p_mean_error_pa(&self) -> f64 {
        self.pressed.solution.p_mean_error
    }

    /// Contact area [m2].
    #[getter]
    fn area_m2(&self) -> f64 {
        self.pressed.solution.area
    }

    /// Error of the area [m2].
    #[getter]
    fn area_error_m2(&self) -> f64 {
        self.pressed.solution.area_error
    }

    /// Extent of the contact along the runner [m].
    #[getter]
    fn length_m(&self) -> f64 {
        self.pressed.solution.length
    }

    /// Error of the length [m].
    #[getter]
    fn length_error_m(&self) -> f64 {
        self.pressed.solution.length_error
    }

    /// Extent of the contact across the runner [m].
    #[getter]
    fn width_m(&self) -> f64 {
        self.pressed.solution.width
    }

    /// Error of the width [m].
    #[getter]
    fn width_error_m(&self) -> f64 {
        self.pressed.solution.width_error
    }

    /// Rigid approach at the origin, from first touch [m].
    #[getter]
    fn approach_m(&self) -> f64 {
        self.pressed.solution.approach
    }

    /// Error of the approach [m].
    #[getter]
    fn approach_error_m(&self) -> f64 {
        self.pressed.solution.approach_error
    }

    /// Pitch about y, positive lowers the nose [rad].
    #[getter]
    fn pitch_rad(&self) -> f64 {
        self.pressed.solution.pitch
    }

    /// Error of the pitch [rad].
    #[getter]
    fn pitch_error_rad(&self) -> f64 {
        self.pressed.solution.pitch_error
    }

    /// Roll about x [rad].
    #[getter]
    fn roll_rad(&self) -> f64 {
        self.pressed.solution.roll
    }

    /// Error of the roll [rad].
    #[getter]
    fn roll_error_rad(&self) -> f64 {
        self.pressed.solution.roll_error
    }

    /// Integrated normal force [N].
    #[getter]
    fn fz_n(&self) -> f64 {
        self.pressed.solution.fz
    }

    /// Largest shear stress in the ice under the peak; `None` where it was not requested or does
    /// not lie under the surface [Pa].
    #[getter]
    fn max_shear_pa(&self) -> Option<f64> {
        self.pressed.solution.under_peak.map(|u| u.shear)
    }

    /// Error of the largest shear stress [Pa].
    #[getter]
    fn max_shear_error_pa(&self) -> Option<f64> {
        self.pressed.solution.under_peak.map(|u| u.shear_error)
    }

    /// Depth of the largest shear stress [m].
    #[getter]
    fn max_shear_depth_m(&self) -> Option<f64> {
        self.pressed.solution.under_peak.map(|u| u.depth)
    }

    /// Error of the depth of the largest shear stress [m].
    #[getter]
    fn max_shear_depth_error_m(&self) -> Option<f64> {
        self.pressed.solution.under_peak.map(|u| u.depth_error)
    }

    /// Node coordinates along the runner, increasing [m].
    #[getter]
    fn x_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.pressed.solution.surface.x.clone().into_pyarray(py)
    }

    /// Node coordinates across the runner, increasing [m].
    #[getter]
    fn y_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.pressed.solution.surface.y.clone().into_pyarray(py)
    }

    /// Contact pressure at the nodes, `len(y_m)` rows of `len(x_m)` [Pa].
    #[getter]
    fn pressure_pa<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.pressed.solution.surface.pressure)
    }

    /// Gap at the nodes, 0 in contact, infinite where there is no hull [m].
    #[getter]
    fn gap_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.pressed.solution.surface.gap)
    }

    /// Vertical displacement of the ice's surface at the nodes, upwards positive [m].
    #[getter]
    fn uz_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.pressed.solution.surface.uz)
    }

    /// Plastic depth of the ice at the nodes, `None` for a runner at rest [m].
    #[getter]
    fn groove_m<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let slid = self.pressed.sliding.as_ref();
        slid.map(|slid| self.on_surface(py, &slid.groove.depth))
            .transpose()
    }

    /// What the reader of the result should know.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.pressed.warnings.clone()
    }

    /// Writes what `kufe press` writes into `folder`, which must be new or empty; all files or
    /// none. `mat` adds `result.mat`.
    #[pyo3(signature = (folder, *, mat = false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, mat: bool) -> PyResult<()> {
        let pressed = self.pressed.clone();
        let worked = work(py, None, move |watch, _| {
            write_folder(&folder, watch, |files| write_contact(files, &pressed, mat))
        })?;
        worked.value.map(|_| ()).map_err(raised)
    }

    /// Draws the pressure over the contact plane with matplotlib, on `ax` or new axes; returns the
    /// axes.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "plot_contact", (slf, ax))
    }

    /// The fields as an `xarray.Dataset` over `y_m` and `x_m`, units in the attributes; needs
    /// xarray.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "contact_to_xarray", (slf,))
    }

    /// The fields as a `pandas.DataFrame`, one row a node; needs pandas.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "contact_to_dataframe", (slf,))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "contact_to_html", (slf,))
    }

    /// What the command writes to `result.json`, the case and the history included.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.pressed.result())
    }

    fn __repr__(&self) -> String {
        let solution = &self.pressed.solution;
        format!(
            "<kufe.Contact p_max {:.2} MPa +- {:.2}, {:.3} mm x {:.4} mm>",
            solution.p_max / 1e6,
            solution.p_max_error / 1e6,
            solution.length * 1e3,
            solution.width * 1e3
        )
    }
}

/// Calls a function of `kufe/_views.py`.
fn view<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl pyo3::call::PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("kufe._views")?.call_method1(name, arguments)
}

impl Contact {
    fn on_surface<'py>(
        &self,
        py: Python<'py>,
        values: &[f64],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let surface = &self.pressed.solution.surface;
        PyArray1::from_slice(py, values).reshape([surface.y.len(), surface.x.len()])
    }
}
