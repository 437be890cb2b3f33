//! Lookup tables.

use std::path::PathBuf;

use kufe::jobs::table::{Solver, TableSpec, fill, read_table};
use kufe::jobs::{case_file::LoadedCase, write_whole};
use kufe::results::lookup_error;
use kufe_lut::{Interpolator, Mode, Point, Quantity};
use numpy::{
    IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::array::numbers;
use crate::contact::{loaded_case, view};
use crate::error::{InputError, bad_input, raised};
use crate::work::work;

/// Lookup table of contact quantities over normal force and track curvature, of a sliding runner
/// also over speed and temperature of the ice.
#[pyclass(frozen, module = "kufe")]
pub struct Table {
    table: kufe_lut::Table,
    /// Where the interpolation is less accurate than the table file requests; `None` if it is
    /// not, and for a table that was read.
    #[pyo3(get)]
    shortfall: Option<String>,
}

/// Number of samples that are interpolated between two checks for Ctrl-C, which takes less than a
/// second.
const SAMPLES_PER_CHECK: usize = 100_000;

/// An interpolated array with its errors and its out-of-range flags.
type Answer<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<bool>>,
);

/// A function and its arguments that restore the object from a pickle.
type Pickled<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>, Option<String>));

#[pymethods]
impl Table {
    /// Reads a `.lut` file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Table> {
        Ok(Table {
            table: work(py, None, move |_, _| read_table(&path))?,
            shortfall: None,
        })
    }

    /// Writes the `.lut` file; it is written completely or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write(&self.table, &path))
    }

    /// Figures at the nodes: an array over force, curvature and, where the table has those axes,
    /// rocker radius, speed and temperature of the ice.
    #[pyo3(signature = (quantity = "p_max"))]
    fn values<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let quantity = self.named(quantity)?;
        let values = self.table.values(quantity).unwrap_or_default();
        values.into_pyarray(py).reshape(self.table.axes().shape())
    }

    /// One quantity at forces [N], curvatures [1/m] and, where the table has those axes, speeds
    /// [m/s], temperatures of the ice [C] and rocker radii [m], which are broadcast; its errors, of
    /// the interpolation and, where known, of the solver (NaN where neither is known); and where an
    /// input was outside the table: the rules of the axes then replace it, and the error is that
    /// within. NaN and masked inputs give NaN and the flag. A rocker radius outside is refused.
    #[pyo3(signature = (fz_n, curvature_1pm, quantity = "p_max", *, v_mps = None, ice_c = None, mode = "smooth", rocker_radius_m = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn lookup<'py>(
        &self,
        py: Python<'py>,
        fz_n: &Bound<'py, PyAny>,
        curvature_1pm: &Bound<'py, PyAny>,
        quantity: &str,
        v_mps: Option<&Bound<'py, PyAny>>,
        ice_c: Option<&Bound<'py, PyAny>>,
        mode: &str,
        rocker_radius_m: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Answer<'py>> {
        let (quantity, mode) = (self.named(quantity)?, mode_of(mode)?);
        let axes = self.table.axes();
        for (key, axis, given) in [
            ("v_mps", axes.speed(), v_mps),
            ("ice_c", axes.ice_c(), ice_c),
        ] {
            let text = match (axis, given) {
                (Some(_), None) => format!("the table has the axis {key}: expected {key} = ..."),
                (None, Some(_)) => format!("{key}: the table has no such axis"),
                _ => continue,
            };
            return Err(InputError::new_err(text));
        }
        let nothing = f64::NAN.into_pyobject(py)?.into_any();
        let given = [
            Some(fz_n),
            Some(curvature_1pm),
            v_mps,
            ice_c,
            rocker_radius_m,
        ];
        let inputs = broadcast(py, given.map(|given| given.unwrap_or(&nothing)))?;
        let shape = inputs[0].shape().to_vec();
        let [fz, curvature, speed, ice, radius] = &inputs;
        let (fz, curvature) = (fz.as_slice()?, curvature.as_slice()?);
        let (speed, ice) = (speed.as_slice()?, ice.as_slice()?);
        let radius = radius.as_slice()?;
        let (mut values, mut outside) = (vec![f64::NAN; fz.len()], vec![true; fz.len()]);
        // An interpolator is of one rocker radius.
        let mut order: Vec<usize> = (0..fz.len()).collect();
        order.sort_by(|&a, &b| radius[a].total_cmp(&radius[b]));
        for same in order.chunk_by(|&a, &b| radius[a].total_cmp(&radius[b]).is_eq()) {
            let radius = rocker_radius_m.map(|_| radius[same[0]]);
            let interpolator = Interpolator::new(&self.table, quantity, mode, radius);
            let interpolator = interpolator.map_err(bad_input)?;
            for part in same.chunks(SAMPLES_PER_CHECK) {
                py.detach(|| {
                    for &n in part {
                        let point = Point::sliding(fz[n], curvature[n], speed[n], ice[n]);
                        let found = interpolator.at(point);
                        (values[n], outside[n]) = (found.value, found.out_of_range);
                    }
                });
                py.check_signals()?;
            }
        }
        let relative = lookup_error(&self.table, quantity, mode).map_err(bad_input)?;
        let relative = relative.unwrap_or(f64::NAN);
        let errors: Vec<f64> = values
            .iter()
            .map(|value| (relative * value).abs())
            .collect();
        Ok((
            values.into_pyarray(py).reshape(shape.clone())?,
            errors.into_pyarray(py).reshape(shape.clone())?,
            outside.into_pyarray(py).reshape(shape)?,
        ))
    }

    /// Largest relative interpolation error measured between the nodes; `None` where none was
    /// measured.
    #[pyo3(signature = (quantity = "p_max", *, mode = "smooth"))]
    fn interpolation_error(&self, quantity: &str, mode: &str) -> PyResult<Option<f64>> {
        let measured = self
            .table
            .interpolation_error(self.named(quantity)?, mode_of(mode)?)
            .map_err(bad_input)?;
        Ok(measured.map(|measured| measured.max))
    }

    /// Breakpoints of the normal force [N].
    #[getter]
    fn fz_n<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.table.axes().fz())
    }

    /// Track curvatures of the nodes, positive in a valley [1/m]: breakpoints, or `len(fz_n)` rows
    /// where the table's axis is the reduced curvature, whose track curvature depends on the force.
    #[getter]
    fn curvature_1pm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let axes = self.table.axes();
        if axes.flush().is_none() {
            return Ok(PyArray1::from_slice(py, axes.curvature()).to_dyn().clone());
        }
        let (fz, reduced) = (axes.fz(), axes.curvature());
        let row = |fz| reduced.iter().map(move |&t| axes.curvature_at(fz, t));
        let all = PyArray1::from_iter(py, fz.iter().flat_map(|&fz| row(fz)));
        Ok(all.reshape([fz.len(), reduced.len()])?.to_dyn().clone())
    }

    /// Breakpoints of the reduced curvature, from 0 to 1, where the table has that axis.
    #[getter]
    fn reduced_curvature<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let axes = self.table.axes();
        axis(py, axes.flush().map(|_| axes.curvature()))
    }

    /// Breakpoints of the rocker radius, where the table has that axis [m].
    #[getter]
    fn rocker_radius_m<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        axis(py, self.table.axes().rocker_radius())
    }

    /// Breakpoints of the speed, where the table has that axis [m/s].
    #[getter]
    fn v_mps<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        axis(py, self.table.axes().speed())
    }

    /// Breakpoints of the temperature of the ice, where the table has that axis [C].
    #[getter]
    fn ice_c<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        axis(py, self.table.axes().ice_c())
    }

    /// Largest estimated solver error over the nodes, relative: of the peak pressure, or of mu
    /// where the runner slides.
    #[getter]
    fn solver_error(&self) -> f64 {
        self.table.solver_error()
    }

    /// One quantity at the nodes as an `xarray.DataArray` over the table's axes, with the
    /// track curvatures of the nodes as a coordinate; needs xarray.
    #[pyo3(signature = (quantity = "p_max"))]
    fn to_xarray<'py>(slf: &Bound<'py, Self>, quantity: &str) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "table_to_xarray", (slf, quantity))
    }

    /// Every quantity as a `pandas.DataFrame`, one row a node, with the track curvature of each;
    /// needs pandas.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        view(slf.py(), "table_to_dataframe", (slf,))
    }

    /// Names of the quantities in the table.
    #[getter]
    fn quantities(&self) -> Vec<&'static str> {
        let quantities = self.table.quantities().iter();
        quantities.map(|quantity| quantity.name()).collect()
    }

    /// The table of a pickle: a `.lut` file's content.
    #[staticmethod]
    fn _of_bytes(mut bytes: &[u8], shortfall: Option<String>) -> PyResult<Table> {
        let table = kufe_lut::Table::read(&mut bytes).map_err(bad_input)?;
        Ok(Table { table, shortfall })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let mut bytes = Vec::new();
        slf.get().table.write(&mut bytes).map_err(bad_input)?;
        let of_bytes = slf.py().import("kufe._views")?.getattr("table_of_bytes")?;
        let content = PyBytes::new(slf.py(), &bytes);
        Ok((of_bytes, (content, slf.get().shortfall.clone())))
    }

    fn __repr__(&self) -> String {
        let axes = self.table.axes();
        let further = [
            (axes.rocker_radius(), "rocker radii"),
            (axes.speed(), "speeds"),
            (axes.ice_c(), "temperatures"),
        ];
        let further: String = further
            .into_iter()
            .filter_map(|(axis, name)| Some(format!(" x {} {name}", axis?.len())))
            .collect();
        format!(
            "<kufe.Table {} forces x {} curvatures{further}>",
            axes.fz().len(),
            axes.curvature().len()
        )
    }
}

impl Table {
    /// The quantity of this name in the table.
    fn named(&self, quantity: &str) -> PyResult<Quantity> {
        let among = self.table.quantities();
        let found = among.iter().find(|q| q.name() == quantity);
        found.copied().ok_or_else(|| {
            let known: Vec<&str> = among.iter().map(|q| q.name()).collect();
            let known = known.join(", ");
            InputError::new_err(format!("quantity {quantity:?}: expected one of {known}"))
        })
    }
}

/// Solves every point of the table that a table file specifies and writes it to `out`, the file's
/// name with `.lut` where absent. Solved points are stored next to it: after Ctrl-C the same call
/// resumes. `case`, as for `press`, replaces the case that the table file names.
#[pyfunction]
#[pyo3(signature = (table, out = None, *, case = None, progress = None))]
pub fn fill_table(
    py: Python<'_>,
    table: PathBuf,
    out: Option<PathBuf>,
    case: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let out = out.unwrap_or_else(|| table.with_extension("lut"));
    let path = out.clone();
    let case = case.map(loaded_case).transpose()?;
    let filled = work(py, progress, move |watch, _| {
        let spec = TableSpec::read(&table)?;
        let loaded = case.map_or_else(|| LoadedCase::read(&spec.case), Ok)?;
        let solver = Solver::new(&spec, loaded, watch)?;
        fill(&spec, &solver, &path, watch)
    })?;
    py.detach(|| write(&filled.swept.table, &out))?;
    filled.clear().map_err(raised)?;
    Ok(Table {
        shortfall: filled.swept.shortfall.map(|error| error.to_string()),
        table: filled.swept.table,
    })
}

fn write(table: &kufe_lut::Table, path: &std::path::Path) -> PyResult<()> {
    let mut bytes = Vec::new();
    table.write(&mut bytes).map_err(bad_input)?;
    write_whole(path, |writer| writer.write_all(&bytes)).map_err(raised)
}

/// The breakpoints of an axis; `None` without the axis.
fn axis<'py>(py: Python<'py>, values: Option<&[f64]>) -> Option<Bound<'py, PyArray1<f64>>> {
    values.map(|values| PyArray1::from_slice(py, values))
}

fn mode_of(name: &str) -> PyResult<Mode> {
    let mode = Mode::ALL.into_iter().find(|mode| mode.name() == name);
    mode.ok_or_else(|| InputError::new_err(format!("mode {name:?}: expected smooth or bilinear")))
}

/// Inputs as contiguous arrays of one shape, by the broadcasting rules of NumPy.
fn broadcast<'py, const N: usize>(
    py: Python<'py>,
    inputs: [&Bound<'py, PyAny>; N],
) -> PyResult<[PyReadonlyArrayDyn<'py, f64>; N]> {
    let numpy = py.import("numpy")?;
    let inputs = inputs.iter().map(|given| Ok((*numbers(given)?).clone()));
    let inputs = PyTuple::new(py, inputs.collect::<PyResult<Vec<_>>>()?)?;
    let all = numpy.call_method1("broadcast_arrays", inputs)?;
    let mut arrays = Vec::with_capacity(N);
    for index in 0..N {
        // In C order, which a broadcast array's own order need not be.
        let array = numpy.call_method1("require", (all.get_item(index)?, py.None(), "C"))?;
        arrays.push(array.extract()?);
    }
    arrays
        .try_into()
        .map_err(|_| InputError::new_err("arrays that cannot be broadcast"))
}
