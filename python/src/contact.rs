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
    /// A case from TOML; a hull's path starts from `folder`. `hull` replaces the file that
    /// `runner.hull` names; messages call the case `name`.
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
        let values = values.iter().map(|(key, value)| {
            let key: String = key.extract()?;
            let value = toml_value(&key, &value)?;
            Ok((key, value))
        });
        let values = values.collect::<PyResult<Vec<_>>>()?;
        Ok(Case {
            loaded: replaced(&self.loaded, &values)?,
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
#[pyclass(frozen, get_all, module = "kufe")]
pub struct Contact {
    /// Peak pressure [Pa].
    p_max_pa: f64,
    /// Estimated discretisation error of the peak pressure [Pa].
    p_max_error_pa: f64,
    /// Force over contact area [Pa].
    p_mean_pa: f64,
    /// Error of the mean pressure [Pa].
    p_mean_error_pa: f64,
    /// Contact area [m2].
    area_m2: f64,
    /// Error of the area [m2].
    area_error_m2: f64,
    /// Extent of the contact along the runner [m].
    length_m: f64,
    /// Error of the length [m].
    length_error_m: f64,
    /// Extent of the contact across the runner [m].
    width_m: f64,
    /// Error of the width [m].
    width_error_m: f64,
    /// Rigid approach at the origin, from first touch [m].
    approach_m: f64,
    /// Error of the approach [m].
    approach_error_m: f64,
    /// Pitch about y, positive lowers the nose [rad].
    pitch_rad: f64,
    /// Error of the pitch [rad].
    pitch_error_rad: f64,
    /// Roll about x [rad].
    roll_rad: f64,
    /// Error of the roll [rad].
    roll_error_rad: f64,
    /// Integrated normal force [N].
    fz_n: f64,
    /// Largest shear stress in the ice under the peak; `None` where it was not requested or does
    /// not lie under the surface [Pa].
    max_shear_pa: Option<f64>,
    /// Error of the largest shear stress [Pa].
    max_shear_error_pa: Option<f64>,
    /// Depth of the largest shear stress [m].
    max_shear_depth_m: Option<f64>,
    /// Error of the depth of the largest shear stress [m].
    max_shear_depth_error_m: Option<f64>,
    #[pyo3(name = "_solved")]
    solved: Py<Solved>,
}

/// The whole of a solved case.
#[pyclass(frozen, module = "kufe")]
struct Solved(Arc<SolvedContact>);

impl Contact {
    fn new(py: Python<'_>, solved: SolvedContact) -> PyResult<Contact> {
        let solution = &solved.solution;
        Ok(Contact {
            p_max_pa: solution.p_max,
            p_max_error_pa: solution.p_max_error,
            p_mean_pa: solution.p_mean,
            p_mean_error_pa: solution.p_mean_error,
            area_m2: solution.area,
            area_error_m2: solution.area_error,
            length_m: solution.length,
            length_error_m: solution.length_error,
            width_m: solution.width,
            width_error_m: solution.width_error,
            approach_m: solution.approach,
            approach_error_m: solution.approach_error,
            pitch_rad: solution.pitch,
            pitch_error_rad: solution.pitch_error,
            roll_rad: solution.roll,
            roll_error_rad: solution.roll_error,
            fz_n: solution.fz,
            max_shear_pa: solution.under_peak.map(|u| u.shear),
            max_shear_error_pa: solution.under_peak.map(|u| u.shear_error),
            max_shear_depth_m: solution.under_peak.map(|u| u.depth),
            max_shear_depth_error_m: solution.under_peak.map(|u| u.depth_error),
            solved: Py::new(py, Solved(Arc::new(solved)))?,
        })
    }

    fn solved(&self) -> &Arc<SolvedContact> {
        &self.solved.get().0
    }
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
    let loaded = replaced(&loaded_case(case)?, &keys)?;
    solved(py, loaded, options, progress)
}

/// Solves steady sliding on ice that yields: the groove that the runner ploughs and the melt film
/// in it.
///
/// As `press` on a case with `sliding.v_mps` and `sliding.ice_c`; the other keys of `[sliding]` are
/// the case's. `result` holds the coefficient of friction with its parts, `groove_m` the plastic depth
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
    let loaded = replaced(&loaded_case(case)?, &keys)?;
    solved(py, loaded, Options::default(), progress)
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
fn replaced<K: AsRef<str>>(loaded: &LoadedCase, keys: &[(K, toml::Value)]) -> PyResult<LoadedCase> {
    if keys.is_empty() {
        return Ok(loaded.clone());
    }
    let mut table = toml::Table::try_from(&loaded.case).map_err(bad_input)?;
    for (key, value) in keys {
        set(&mut table, key.as_ref(), value.clone())?;
    }
    let text = toml::to_string(&table).map_err(bad_input)?;
    let mut other = LoadedCase::parse(&loaded.name, &loaded.base, &text).map_err(raised)?;
    other.hull.clone_from(&loaded.hull);
    Ok(other)
}

fn solved(
    py: Python<'_>,
    loaded: LoadedCase,
    options: Options,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Contact> {
    let watched = progress.is_some();
    let worked = work(py, progress, move |watch, reporter| {
        let options = Options {
            stop: Some(reporter.stop.clone()),
            ..options
        };
        let options = if watched {
            with_progress(options, &loaded.case, move |line| reporter.progress(line))
        } else {
            options
        };
        kufe::Contact::from(loaded).options(options).best(watch)
    })?;
    let pressed = worked.value.map_err(raised)?;
    let short = pressed.short.clone();
    let contact = Contact::new(py, pressed)?;
    let Some(failure) = short else {
        return Ok(contact);
    };
    let error = raised(failure);
    error.value(py).setattr("best", contact)?;
    Err(error)
}

#[pymethods]
impl Contact {
    /// Node coordinates along the runner, increasing [m].
    #[getter]
    fn x_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.solved().solution.surface.x.clone().into_pyarray(py)
    }

    /// Node coordinates across the runner, increasing [m].
    #[getter]
    fn y_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.solved().solution.surface.y.clone().into_pyarray(py)
    }

    /// Contact pressure at the nodes, `len(y_m)` rows of `len(x_m)` [Pa].
    #[getter]
    fn pressure_pa<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.solved().solution.surface.pressure)
    }

    /// Gap at the nodes, 0 in contact, infinite where there is no hull [m].
    #[getter]
    fn gap_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.solved().solution.surface.gap)
    }

    /// Vertical displacement of the ice's surface at the nodes, upwards positive [m].
    #[getter]
    fn uz_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, &self.solved().solution.surface.uz)
    }

    /// Plastic depth of the ice at the nodes, `None` for a runner at rest [m].
    #[getter]
    fn groove_m<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let slid = self.solved().sliding.as_ref();
        slid.map(|slid| self.on_surface(py, &slid.groove.depth))
            .transpose()
    }

    /// Warnings and remarks.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.solved().warnings.clone()
    }

    /// Writes what `kufe press` writes into `folder`, which must be new or empty; all files or
    /// none. `mat` adds `result.mat`.
    #[pyo3(signature = (folder, *, mat = false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, mat: bool) -> PyResult<()> {
        let pressed = self.solved().clone();
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
        to_python(py, &self.solved().result())
    }

    fn __repr__(&self) -> String {
        let solution = &self.solved().solution;
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
pub fn view<'py>(
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
        let surface = &self.solved().solution.surface;
        PyArray1::from_slice(py, values).reshape([surface.y.len(), surface.x.len()])
    }
}
