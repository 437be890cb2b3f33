//! Lookup tables.

use std::path::PathBuf;

use kufe_jobs::table::{Solver, Wanted, fill, read_table};
use kufe_jobs::write_whole;
use kufe_lut::{Lookup, Mode, Quantity};
use numpy::{
    IntoPyArray, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::error::{InputError, bad_input, raised};
use crate::work::work;

/// Contact figures over normal force and track curvature.
#[pyclass(frozen, module = "kufe")]
pub struct Table {
    table: kufe_lut::Table,
    shortfall: Option<String>,
}

/// A looked-up array with its out-of-range flags.
type Answer<'py> = (Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyArrayDyn<bool>>);

#[pymethods]
impl Table {
    /// Reads a `.lut` file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Table> {
        let table = py.detach(|| read_table(&path)).map_err(raised)?;
        Ok(Table {
            table,
            shortfall: None,
        })
    }

    /// Writes the `.lut` file; it is whole or absent.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write(&self.table, &path))
    }

    /// Figures at the nodes: an array over force, curvature and, where the table has that axis, rocker radius.
    #[pyo3(signature = (quantity = "p_max"))]
    fn values<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let quantity = named(quantity)?;
        let axes = self.table.axes();
        let mut shape = vec![axes.fz().len(), axes.curvature().len()];
        shape.extend(axes.rocker_radius().map(<[f64]>::len));
        let values: Vec<f64> = self.table.nodes().iter().map(|n| n.get(quantity)).collect();
        values.into_pyarray(py).reshape(shape)
    }

    /// One quantity at forces [N] and curvatures [1/m], which are broadcast, and where an input was outside the table
    /// and clipped to it; NaN gives NaN and the flag.
    #[pyo3(signature = (fz_n, curvature_1pm, quantity = "p_max", *, mode = "smooth", rocker_radius_m = None))]
    fn lookup<'py>(
        &self,
        py: Python<'py>,
        fz_n: &Bound<'py, PyAny>,
        curvature_1pm: &Bound<'py, PyAny>,
        quantity: &str,
        mode: &str,
        rocker_radius_m: Option<f64>,
    ) -> PyResult<Answer<'py>> {
        let (quantity, mode) = (named(quantity)?, mode_of(mode)?);
        let (fz, curvature) = broadcast(py, fz_n, curvature_1pm)?;
        let shape = fz.shape().to_vec();
        let (fz, curvature) = (fz.as_slice()?, curvature.as_slice()?);
        let (values, outside): (Vec<f64>, Vec<bool>) = py.detach(|| {
            let lookup = Lookup::with_rocker(&self.table, quantity, mode, rocker_radius_m)
                .map_err(bad_input)?;
            let answers = fz.iter().zip(curvature).map(|(&fz, &curvature)| {
                let looked = lookup.at(fz, curvature);
                (looked.value, looked.out_of_range)
            });
            Ok::<_, PyErr>(answers.unzip())
        })?;
        Ok((
            values.into_pyarray(py).reshape(shape.clone())?,
            outside.into_pyarray(py).reshape(shape)?,
        ))
    }

    /// Largest relative interpolation error measured between the nodes; `None` where none was measured.
    #[pyo3(signature = (quantity = "p_max", *, mode = "smooth"))]
    fn interpolation_error(&self, quantity: &str, mode: &str) -> PyResult<Option<f64>> {
        let measured = self
            .table
            .interpolation_error(named(quantity)?, mode_of(mode)?)
            .map_err(bad_input)?;
        Ok(measured.map(|measured| measured.max))
    }

    /// Breakpoints of the normal force [N].
    #[getter]
    fn fz_n<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.table.axes().fz())
    }

    /// Breakpoints of the track's curvature, positive in a valley [1/m].
    #[getter]
    fn curvature_1pm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.table.axes().curvature())
    }

    /// Breakpoints of the rocker radius, where the table has that axis [m].
    #[getter]
    fn rocker_radius_m<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let radii = self.table.axes().rocker_radius();
        radii.map(|radii| PyArray1::from_slice(py, radii))
    }

    /// Largest estimated solver error of the peak pressure over the nodes, relative.
    #[getter]
    fn solver_error(&self) -> f64 {
        self.table.solver_error()
    }

    /// Where the interpolation is less accurate than the table file asked; `None` where it is not, and for a table
    /// that was read.
    #[getter]
    fn shortfall(&self) -> Option<&str> {
        self.shortfall.as_deref()
    }

    fn __repr__(&self) -> String {
        let axes = self.table.axes();
        let rockers = match axes.rocker_radius() {
            Some(radii) => format!(" x {} rocker radii", radii.len()),
            None => String::new(),
        };
        format!(
            "<kufe.Table {} forces x {} curvatures{rockers}>",
            axes.fz().len(),
            axes.curvature().len()
        )
    }
}

/// Solves every point of the table that a table file asks for and writes it to `out`, the file's name with `.lut` where
/// absent. Points are kept beside it meanwhile: after Ctrl-C the same call resumes.
#[pyfunction]
#[pyo3(signature = (table, out = None, *, progress = None))]
pub fn fill_table(
    py: Python<'_>,
    table: PathBuf,
    out: Option<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let out = out.unwrap_or_else(|| table.with_extension("lut"));
    let worked = work(py, progress, |watch, _| {
        let wanted = Wanted::read(&table)?;
        let solver = Solver::new(&wanted, watch)?;
        fill(&wanted, &solver, &out, watch)
    })?;
    let filled = worked.value.map_err(raised)?;
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

fn named(quantity: &str) -> PyResult<Quantity> {
    Quantity::from_name(quantity).ok_or_else(|| {
        let known: Vec<&str> = Quantity::ALL.iter().map(|q| q.name()).collect();
        InputError::new_err(format!(
            "quantity {quantity:?}: expected one of {}",
            known.join(", ")
        ))
    })
}

fn mode_of(name: &str) -> PyResult<Mode> {
    let mode = Mode::ALL.into_iter().find(|mode| mode.name() == name);
    mode.ok_or_else(|| InputError::new_err(format!("mode {name:?}: expected smooth or bilinear")))
}

type Pair<'py> = (PyReadonlyArrayDyn<'py, f64>, PyReadonlyArrayDyn<'py, f64>);

/// Two inputs as contiguous arrays of one shape, by NumPy's own rules.
fn broadcast<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
) -> PyResult<Pair<'py>> {
    let numpy = py.import("numpy")?;
    let both = numpy.call_method1("broadcast_arrays", (a, b))?;
    // In C order, which a broadcast array's own order need not be.
    let order = [("order", "C")].into_py_dict(py)?;
    let contiguous = |index: usize| -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
        let input = (both.get_item(index)?, "float64");
        let array = numpy.call_method("array", input, Some(&order))?;
        array.extract()
    };
    Ok((contiguous(0)?, contiguous(1)?))
}
