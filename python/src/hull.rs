//! Hulls.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::{ExaminedHull, write_whole};
use kufe_mesh::{
    Axis, BobRunner, HullFormat, HullOptions, HullReport, LugeSteel, MeshError, load_hull,
    tessellate, tessellate_steel,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::array::{integers, list, numbers};
use crate::contact::Case;
use crate::error::{InputError, bad_input, raised};
use crate::json::to_python;
use crate::work::work;

/// Triangles of a runner, x forward and z up.
#[pyclass(frozen, module = "kufe")]
pub struct Hull {
    hull: Arc<kufe_mesh::Hull>,
    report: HullReport,
}

#[pymethods]
impl Hull {
    /// A hull of arrays: one row per vertex [m], one row of three vertex indices per triangle,
    /// counter-clockwise seen from outside.
    #[new]
    fn new(
        py: Python<'_>,
        vertices_m: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
    ) -> PyResult<Hull> {
        let positions = triples(&numbers(vertices_m)?, "vertices_m")?;
        let triangles = triples(&integers(triangles, "triangles")?, "triangles")?;
        let index = |k: i64| match usize::try_from(k) {
            Ok(number) if number < positions.len() => Ok(number as u32),
            _ => Err(InputError::new_err(format!(
                "triangles: found the vertex {k}, expected 0 to {}",
                positions.len().saturating_sub(1)
            ))),
        };
        let corners = |row: &[i64; 3]| Ok([index(row[0])?, index(row[1])?, index(row[2])?]);
        let triangles: PyResult<Vec<[u32; 3]>> = triangles.iter().map(corners).collect();
        let hull = kufe_mesh::Hull {
            positions,
            triangles: triangles?,
        };
        work(py, None, move |_, _| Hull::checked(hull))
    }

    /// The underside of a measured height map: `heights_m` has `len(y_m)` rows of `len(x_m)`, z up;
    /// what is masked or not finite was not measured.
    #[staticmethod]
    fn from_heights(
        py: Python<'_>,
        x_m: &Bound<'_, PyAny>,
        y_m: &Bound<'_, PyAny>,
        heights_m: &Bound<'_, PyAny>,
    ) -> PyResult<Hull> {
        let (x_m, y_m) = (list(x_m, "x_m")?, list(y_m, "y_m")?);
        let heights_m = numbers(heights_m)?;
        let (found, expected) = (heights_m.shape(), [y_m.len(), x_m.len()]);
        if found != expected {
            return Err(InputError::new_err(format!(
                "heights_m: found an array of shape {found:?}, expected {expected:?}"
            )));
        }
        for (name, axis) in [("x_m", &x_m), ("y_m", &y_m)] {
            if !axis.is_sorted_by(|a, b| a < b) {
                let text = format!("{name}: expected numbers that increase");
                return Err(InputError::new_err(text));
            }
        }
        let heights: Vec<f64> = heights_m.as_array().iter().copied().collect();
        let hull = kufe_mesh::Hull::underside_of(&x_m, &y_m, &heights);
        if hull.triangles.is_empty() {
            let text = "heights_m: expected measured heights at the four corners of a cell";
            return Err(InputError::new_err(text));
        }
        work(py, None, move |_, _| Hull::checked(hull))
    }

    /// Reads and checks an OBJ, glTF, STL or 3MF file; `scale` is the number of metres per unit of
    /// the file (0.001 for millimetres), `up` and `forward` are its axes (`"z"`, `"-x"`; without
    /// `up` y for glTF, else z).
    #[staticmethod]
    #[pyo3(signature = (path, *, scale = 1.0, up = None, forward = "x"))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        scale: f64,
        up: Option<&str>,
        forward: &str,
    ) -> PyResult<Hull> {
        let axis = |text: &str| text.parse::<Axis>().map_err(bad_input);
        let options = HullOptions {
            scale,
            up: up.map(axis).transpose()?,
            forward: axis(forward)?,
            ..HullOptions::default()
        };
        work(py, None, move |_, _| {
            let (hull, report) = load_hull(&path, &options)?;
            let hull = Arc::new(hull);
            Ok::<_, MeshError>(Hull { hull, report })
        })
    }

    /// A bobsled runner: a round section swept along a rocker, with rounded ends; `edge_length_m`
    /// is that of the triangles on the underside.
    #[staticmethod]
    #[pyo3(signature = (
        *,
        length_m = 1.0,
        rocker_radius_m = 30.0,
        section_radius_m = 0.005,
        width_m = 0.010,
        height_m = 0.030,
        edge_length_m = 0.0005,
    ))]
    fn bob(
        py: Python<'_>,
        length_m: f64,
        rocker_radius_m: f64,
        section_radius_m: f64,
        width_m: f64,
        height_m: f64,
        edge_length_m: f64,
    ) -> PyResult<Hull> {
        let runner = BobRunner {
            length: length_m,
            rocker_radius: rocker_radius_m,
            section_radius: section_radius_m,
            width: width_m,
            height: height_m,
        };
        work(py, None, move |_, _| {
            Hull::checked(tessellate(&runner.swept()?, edge_length_m)?)
        })
    }

    /// A luge steel on its rounded edge.
    #[staticmethod]
    #[pyo3(signature = (
        *,
        length_m = 0.6,
        rocker_radius_m = 25.0,
        edge_radius_m = 0.0003,
        tilt_rad = 0.02,
        width_m = 0.020,
        height_m = 0.008,
        edge_length_m = 0.0005,
    ))]
    #[allow(clippy::too_many_arguments)] // keywords in Python
    fn luge(
        py: Python<'_>,
        length_m: f64,
        rocker_radius_m: f64,
        edge_radius_m: f64,
        tilt_rad: f64,
        width_m: f64,
        height_m: f64,
        edge_length_m: f64,
    ) -> PyResult<Hull> {
        let steel = LugeSteel {
            length: length_m,
            rocker_radius: rocker_radius_m,
            edge_radius: edge_radius_m,
            tilt: tilt_rad,
            width: width_m,
            height: height_m,
        };
        work(py, None, move |_, _| {
            Hull::checked(tessellate_steel(&steel.swept()?, edge_length_m)?)
        })
    }

    /// Writes the hull as .obj, .glb or .stl, in metres; a file is written completely or not at
    /// all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let format = HullFormat::of_output(&path).map_err(bad_input)?;
        let hull = self.hull.clone();
        work(py, None, move |_, _| {
            write_whole(&path, |writer| format.write(&hull, writer))
        })
    }

    /// Vertex positions, one row per vertex [m].
    #[getter]
    fn vertices_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.hull.positions)
    }

    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.hull.triangles)
    }

    /// Size along x, y and z [m].
    #[getter]
    fn extent_m(&self) -> (f64, f64, f64) {
        let [x, y, z] = self.report.extent;
        (x, y, z)
    }

    /// Enclosed volume; not meaningful for an open hull [m3].
    #[getter]
    fn volume_m3(&self) -> f64 {
        self.report.volume
    }

    /// Warnings about the hull.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        Ok((self.vertices_m(py)?, self.triangles(py)?))
    }

    fn __repr__(&self) -> String {
        let (vertices, triangles) = (self.hull.positions.len(), self.hull.triangles.len());
        format!("<kufe.Hull {vertices} vertices, {triangles} triangles>")
    }
}

/// Check of a scanned hull: options to read its file, and the loads that it resolves.
#[pyclass(frozen, module = "kufe")]
pub struct HullCheck {
    examined: ExaminedHull,
}

/// Checks a scanned hull: unit, axes, rotation, spacing, noise, and the loads that it resolves.
///
/// `fz_n` are normal forces [N]; `p_max` is the requested relative error of the peak pressure, where
/// absent 0.05, or 0.01 for a hull without noise.
#[pyfunction]
#[pyo3(
    signature = (path, fz_n = None, *, p_max = None, progress = None),
    text_signature = "(path, fz_n=(250.0, 500.0, 1000.0, 2000.0, 4000.0), *, p_max=None, progress=None)"
)]
pub fn check_hull(
    py: Python<'_>,
    path: PathBuf,
    fz_n: Option<&Bound<'_, PyAny>>,
    p_max: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<HullCheck> {
    let fz_n = match fz_n {
        Some(fz_n) => list(fz_n, "fz_n")?,
        None => vec![250.0, 500.0, 1000.0, 2000.0, 4000.0],
    };
    if let Some(fz) = fz_n.iter().find(|fz| !(**fz > 0.0 && fz.is_finite())) {
        let text = format!("fz_n = {fz}: expected positive forces [N]");
        return Err(InputError::new_err(text));
    }
    if let Some(share) = p_max.filter(|share| !(1e-4..=0.5).contains(share)) {
        let text = format!("p_max = {share}: expected a relative error from 1e-4 to 0.5");
        return Err(InputError::new_err(text));
    }
    let examined = work(py, progress, move |watch, _| {
        watch.progress("examining the hull");
        kufe::jobs::check_hull(&path, &fz_n, p_max)
    })?;
    Ok(HullCheck { examined })
}

#[pymethods]
impl HullCheck {
    /// The output of the command with `--json`.
    #[getter]
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.examined.result)
    }

    /// Warnings about the hull.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.examined.result.warnings.clone()
    }

    /// The case that reads the hull so, on the ice of the example under the force that is nearest
    /// to 1 kN.
    fn case(&self) -> PyResult<Case> {
        let text = self.examined.case(Path::new("")).map_err(raised)?;
        let name = self.examined.result.file.display().to_string();
        let loaded = LoadedCase::parse(&name, Path::new(""), &text).map_err(raised)?;
        Ok(Case { loaded })
    }

    fn __repr__(&self) -> String {
        let result = &self.examined.result;
        let loads = result.loads.iter().flatten();
        let resolved = loads.clone().filter(|load| load.resolved).count();
        format!(
            "<kufe.HullCheck {}: {resolved} of {} loads resolved>",
            result.file.display(),
            loads.count()
        )
    }
}

/// Vertices [m] and triangles.
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

impl Hull {
    /// A hull with its warnings.
    pub fn checked(hull: kufe_mesh::Hull) -> Result<Hull, MeshError> {
        let (hull, report) = kufe_mesh::checked_runner(hull)?;
        let hull = Arc::new(hull);
        Ok(Hull { hull, report })
    }

    /// The triangles.
    pub fn shared(&self) -> Arc<kufe_mesh::Hull> {
        self.hull.clone()
    }
}

/// The rows of an array, of three numbers each.
fn triples<T: numpy::Element + Copy>(
    array: &PyReadonlyArrayDyn<'_, T>,
    name: &str,
) -> PyResult<Vec<[T; 3]>> {
    let &[rows, 3] = array.shape() else {
        return Err(InputError::new_err(format!(
            "{name}: found an array of shape {:?}, expected rows of three",
            array.shape()
        )));
    };
    let numbers: Vec<T> = array.as_array().iter().copied().collect();
    let (all, _) = numbers.as_chunks::<3>();
    assert_eq!(all.len(), rows);
    Ok(all.to_vec())
}

fn rows<'py, T: numpy::Element + Copy>(
    py: Python<'py>,
    rows: &[[T; 3]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), 3])
}
