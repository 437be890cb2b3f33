//! Cases and their solutions.

use std::path::PathBuf;
use std::sync::Arc;

use kufe::jobs::field::write_contact;
use kufe::jobs::{Failure, SolvedContact, case_file::LoadedCase, with_progress};
use kufe_contact::{Options, PressureMap};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt};
use serde_json::Value;

use crate::error::{InputError, bad_input, raised};
use crate::folder::write_folder;
use crate::hull::Hull;
use crate::json::to_python;
use crate::work::work;

/// One contact problem: runner, ice, track and load.
#[pyclass(frozen, module = "kufe")]
pub struct Case {
    /// The case with its file name and hull.
    pub loaded: LoadedCase,
}

#[pymethods]
impl Case {
    /// A case from TOML; a hull's path starts from `folder`. `hull` replaces the file that
    /// `runner.hull` names; messages call the case `name`.
    #[new]
    #[pyo3(
        signature = (text, folder = PathBuf::new(), *, name = "the case", hull = None),
        text_signature = "(text, folder='', *, name='the case', hull=None)"
    )]
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

    /// Reads a case file.
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

    /// The case with other values, by dotted key: `case.replace({"load.fz_n": 2000.0})`. `None`
    /// removes a key.
    fn replace(&self, values: &Bound<'_, PyDict>) -> PyResult<Case> {
        let values = values.iter().map(|(key, value)| {
            let key: String = key.extract()?;
            let value = (!value.is_none()).then(|| toml_value(&key, &value));
            Ok((key, value.transpose()?))
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

    /// Name of the case in messages: its file.
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
        let hull = hull.map(|hull| work(py, None, |_, _| Hull::checked(hull)));
        let hull = hull.transpose()?;
        keywords.set_item("hull", hull)?;
        Ok(((self.to_toml()?, self.loaded.base.clone()), keywords))
    }

    fn __repr__(&self) -> String {
        format!("<kufe.Case {}>", self.loaded.name)
    }
}

fn toml_value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<toml::Value> {
    if let Ok(value) = value.call_method0("tolist") {
        // NumPy's scalars and arrays.
        toml_value(key, &value)
    } else if value.is_instance_of::<PyBool>() {
        Ok(toml::Value::Boolean(value.extract()?))
    } else if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() {
        Ok(toml::Value::Float(value.extract()?))
    } else if let Ok(text) = value.extract::<String>() {
        // As results, which are JSON, spell it.
        Ok(match text.as_str() {
            "inf" => f64::INFINITY.into(),
            _ => text.into(),
        })
    } else if let Ok(values) = value.extract::<Vec<Bound<'_, PyAny>>>() {
        let values = values.iter().map(|value| toml_value(key, value));
        Ok(toml::Value::Array(values.collect::<PyResult<_>>()?))
    } else {
        Err(InputError::new_err(format!(
            "{key}: found {}, expected a number, a truth value, a text or a list",
            value.get_type().name()?
        )))
    }
}

/// Sets the value at a dotted key, or removes it.
fn set(table: &mut toml::Table, key: &str, value: Option<toml::Value>) -> PyResult<()> {
    let (mut table, mut last) = (table, key);
    while let Some((first, rest)) = last.split_once('.') {
        if value.is_none() && !table.contains_key(first) {
            return Ok(());
        }
        let inner = table
            .entry(first)
            .or_insert_with(|| toml::Table::new().into());
        table = inner.as_table_mut().ok_or_else(|| {
            InputError::new_err(format!("{key}: {first} is a value, expected a table"))
        })?;
        last = rest;
    }
    match value {
        Some(value) => table.insert(last.to_owned(), value),
        None => table.remove(last),
    };
    Ok(())
}

/// A solved case.
#[pyclass(frozen, get_all, module = "kufe")]
pub struct Contact {
    /// Peak pressure [Pa].
    p_max_pa: f64,
    /// Error of the peak pressure, including that of a scan [Pa].
    p_max_error_pa: f64,
    /// Mean pressure: ratio of force to contact area [Pa].
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
    /// Largest shear stress in the ice under the peak; `None` if it was not requested or does
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

/// Data of a contact's arrays and dictionaries.
#[pyclass(frozen, module = "kufe")]
struct Solved {
    /// The content of `result.json`.
    result: Value,
    warnings: Vec<String>,
    /// The arrays in the order of [`Field`]; without a groove for a runner at rest.
    arrays: Vec<Vec<f64>>,
    /// The solution with its meshes; `None` for a contact from a pickle.
    contact: Option<Arc<SolvedContact>>,
}

/// Arrays of a contact: coordinates of the nodes, and fields at the nodes.
#[derive(Clone, Copy)]
enum Field {
    X,
    Y,
    Pressure,
    Gap,
    Displacement,
    Groove,
}

impl Solved {
    fn of(contact: SolvedContact) -> PyResult<Solved> {
        let field = &contact.solution.surface;
        let fields = [&field.x, &field.y, &field.pressure, &field.gap, &field.uz];
        let arrays = fields.map(Vec::clone);
        let groove = contact.sliding.iter().map(|slid| slid.groove.depth.clone());
        Ok(Solved {
            result: serde_json::to_value(contact.result()).map_err(bad_input)?,
            warnings: contact.warnings.clone(),
            arrays: arrays.into_iter().chain(groove).collect(),
            contact: Some(Arc::new(contact)),
        })
    }
}

/// A function that makes a contact, and its arguments: the text of `result.json`, warnings, and the
/// arrays.
type Pickled<'py> = (
    Bound<'py, PyAny>,
    (String, Vec<String>, Vec<Bound<'py, PyArray1<f64>>>),
);

impl Contact {
    fn new(py: Python<'_>, solved: Solved) -> PyResult<Contact> {
        let figure = |key: &str| solved.result[key].as_f64().unwrap_or(f64::NAN);
        let under_peak = |key: &str| solved.result["subsurface"][key].as_f64();
        Ok(Contact {
            p_max_pa: figure("p_max_pa"),
            p_max_error_pa: figure("p_max_error_pa"),
            p_mean_pa: figure("p_mean_pa"),
            p_mean_error_pa: figure("p_mean_error_pa"),
            area_m2: figure("area_m2"),
            area_error_m2: figure("area_error_m2"),
            length_m: figure("length_m"),
            length_error_m: figure("length_error_m"),
            width_m: figure("width_m"),
            width_error_m: figure("width_error_m"),
            approach_m: figure("approach_m"),
            approach_error_m: figure("approach_error_m"),
            pitch_rad: figure("pitch_rad"),
            pitch_error_rad: figure("pitch_error_rad"),
            roll_rad: figure("roll_rad"),
            roll_error_rad: figure("roll_error_rad"),
            fz_n: figure("fz_n"),
            max_shear_pa: under_peak("max_shear_pa"),
            max_shear_error_pa: under_peak("max_shear_error_pa"),
            max_shear_depth_m: under_peak("max_shear_depth_m"),
            max_shear_depth_error_m: under_peak("max_shear_depth_error_m"),
            solved: Py::new(py, solved)?,
        })
    }

    fn solved(&self) -> &Solved {
        self.solved.get()
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
    let keys: Vec<_> = accuracy.map(accuracy_key).into_iter().collect();
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
        ("sliding.v_mps", Some(v_mps.into())),
        ("sliding.ice_c", Some(ice_c.into())),
    ];
    keys.extend(accuracy.map(accuracy_key));
    let loaded = replaced(&loaded_case(case)?, &keys)?;
    solved(py, loaded, Options::default(), progress)
}

fn accuracy_key(accuracy: f64) -> (&'static str, Option<toml::Value>) {
    ("accuracy.p_max", Some(accuracy.into()))
}

/// The case of a `Case`, of a `Hull` on the ice of the example, or of the file at a path.
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
fn replaced<K: AsRef<str>>(
    loaded: &LoadedCase,
    keys: &[(K, Option<toml::Value>)],
) -> PyResult<LoadedCase> {
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
    let pressed = work(py, progress, move |watch, reporter| {
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
    let short = pressed.short.clone();
    let contact = Contact::new(py, Solved::of(pressed)?)?;
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
        PyArray1::from_slice(py, self.array(Field::X))
    }

    /// Node coordinates across the runner, increasing [m].
    #[getter]
    fn y_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.array(Field::Y))
    }

    /// Contact pressure at the nodes, `len(y_m)` rows of `len(x_m)` [Pa]. The nodes are not evenly
    /// spaced; `map` has the pressure on an even grid, whose sum is the force.
    #[getter]
    fn pressure_pa<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, Field::Pressure)
    }

    /// Gap at the nodes, 0 within rounding in contact, infinite where there is no hull [m].
    #[getter]
    fn gap_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, Field::Gap)
    }

    /// Vertical displacement of the ice's surface at the nodes, upwards positive [m].
    #[getter]
    fn uz_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.on_surface(py, Field::Displacement)
    }

    /// Plastic depth of the ice at the nodes, `None` for a runner at rest [m].
    #[getter]
    fn groove_m<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let slides = self.solved().arrays.len() > Field::Groove as usize;
        let groove = slides.then(|| self.on_surface(py, Field::Groove));
        groove.transpose()
    }

    /// Arrays by name on an even grid around the contact, as in `result.mat`: `x_m`, `y_m`, and
    /// `len(y_m)` rows of `len(x_m)` of `pressure_pa`, `gap_m` and `uz_m`. The sum of `pressure_pa`
    /// times the area of a pixel is `fz_n`. A contact from a pickle has no map.
    fn map<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contact = self.meshes("map")?;
        let map = work(py, None, move |_, _| {
            Ok::<_, Failure>(PressureMap::of(&contact.solution))
        })?;
        let place = |from: f64, step: f64, count: usize| {
            PyArray1::from_iter(py, (0..count).map(|k| from + k as f64 * step))
        };
        let arrays = PyDict::new(py);
        arrays.set_item("x_m", place(map.x0, map.dx, map.nx))?;
        arrays.set_item("y_m", place(map.y0, map.dy, map.ny))?;
        for (name, values) in [
            ("pressure_pa", map.pressure),
            ("gap_m", map.gap),
            ("uz_m", map.uz),
        ] {
            arrays.set_item(name, values.into_pyarray(py).reshape([map.ny, map.nx])?)?;
        }
        Ok(arrays)
    }

    /// Warnings and remarks.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.solved().warnings.clone()
    }

    /// Writes what `kufe press` writes into `folder`, which must be new or empty; all files or
    /// none. `mat` adds `result.mat`. A contact from a pickle has no meshes to write.
    #[pyo3(signature = (folder, *, mat = false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, mat: bool) -> PyResult<()> {
        let pressed = self.meshes("write")?;
        work(py, None, move |watch, _| {
            write_folder(&folder, watch, |files| write_contact(files, &pressed, mat))
        })?;
        Ok(())
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

    /// The fields as a `pandas.DataFrame`, one row per node; needs pandas.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "contact_to_dataframe", (slf,))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "contact_to_html", (slf,))
    }

    /// What the command writes to `result.json`, the case and the history included. Keys that only
    /// written files have, `p_max_map_pa` and `stress_max_pa`, are absent.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.solved().result)
    }

    /// The contact of a pickle.
    #[staticmethod]
    fn _of_pickle(
        py: Python<'_>,
        result: &str,
        warnings: Vec<String>,
        arrays: Vec<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Contact> {
        if arrays.len() < Field::Groove as usize {
            return Err(bad_input("a pickle without arrays"));
        }
        let arrays = arrays.iter().map(|array| array.as_array().to_vec());
        let solved = Solved {
            result: serde_json::from_str(result).map_err(bad_input)?,
            warnings,
            arrays: arrays.collect(),
            contact: None,
        };
        Contact::new(py, solved)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let (py, solved) = (slf.py(), slf.get().solved());
        let of_pickle = py.import("kufe._views")?.getattr("contact_of_pickle")?;
        let arrays = solved.arrays.iter();
        let arrays = arrays.map(|values| PyArray1::from_slice(py, values));
        let (result, warnings) = (solved.result.to_string(), solved.warnings.clone());
        Ok((of_pickle, (result, warnings, arrays.collect())))
    }

    // A copy keeps the meshes.
    fn __copy__<'py>(slf: &Bound<'py, Self>) -> Bound<'py, Self> {
        slf.clone()
    }

    fn __deepcopy__<'py>(slf: &Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        slf.clone()
    }

    fn __repr__(&self) -> String {
        format!(
            "<kufe.Contact p_max {:.2} MPa +- {:.2}, {:.3} mm x {:.4} mm>",
            self.p_max_pa / 1e6,
            self.p_max_error_pa / 1e6,
            self.length_m * 1e3,
            self.width_m * 1e3
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
    /// The solution with its meshes, for the method of this name.
    fn meshes(&self, method: &str) -> PyResult<Arc<SolvedContact>> {
        self.solved().contact.clone().ok_or_else(|| {
            InputError::new_err(format!(
                "a contact from a pickle has no meshes: expected one that was solved in this process (call {method} before, or solve its case again)",
            ))
        })
    }

    fn array(&self, field: Field) -> &[f64] {
        &self.solved().arrays[field as usize]
    }

    fn on_surface<'py>(
        &self,
        py: Python<'py>,
        field: Field,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let shape = [Field::Y, Field::X].map(|axis| self.array(axis).len());
        PyArray1::from_slice(py, self.array(field)).reshape(shape)
    }
}
