//! Hulls.

use std::path::PathBuf;

use kufe::jobs::write_whole;
use kufe_mesh::{
    Axis, BobRunner, HullFormat, HullOptions, HullReport, LugeSteel, MeshError, Swept, check_hull,
    load_hull, tessellate,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::error::{bad_input, raised};

/// Triangles of a runner, x forward and z up.
#[pyclass(frozen, module = "kufe")]
pub struct Hull {
    hull: kufe_mesh::Hull,
    report: HullReport,
}

#[pymethods]
impl Hull {
    /// Reads and checks an OBJ, glTF, STL or 3MF file; `scale` is metres a unit of the file (0.001
    /// for millimetres), `up` and `forward` its axes (`"z"`, `"-x"`; up is y in glTF and z
    /// elsewhere where absent).
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
        let (hull, report) = py
            .detach(|| load_hull(&path, &options))
            .map_err(bad_input)?;
        Ok(Hull { hull, report })
    }

    /// A bobsled runner: a round section swept along a rocker, with rounded ends; `edge_length_m`
    /// is that of the triangles on the underside.
    #[staticmethod]
    #[pyo3(signature = (
        *,
        length_m = BobRunner::default().length,
        rocker_radius_m = BobRunner::default().rocker_radius,
        section_radius_m = BobRunner::default().section_radius,
        width_m = BobRunner::default().width,
        height_m = BobRunner::default().height,
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
            ..BobRunner::default()
        };
        py.detach(|| tessellated(runner.swept(), edge_length_m))
            .map_err(bad_input)
    }

    /// A luge steel on its rounded edge.
    #[staticmethod]
    #[pyo3(signature = (
        *,
        length_m = LugeSteel::default().length,
        rocker_radius_m = LugeSteel::default().rocker_radius,
        edge_radius_m = LugeSteel::default().edge_radius,
        tilt_rad = LugeSteel::default().tilt,
        width_m = LugeSteel::default().width,
        height_m = LugeSteel::default().height,
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
            ..LugeSteel::default()
        };
        py.detach(|| tessellated(steel.swept(), edge_length_m))
            .map_err(bad_input)
    }

    /// Writes the hull as .obj, .glb or .stl, in metres; a file is whole or absent.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let format = HullFormat::of(&path).map_err(bad_input)?;
        py.detach(|| write_whole(&path, |writer| format.write(&self.hull, writer)))
            .map_err(raised)
    }

    /// Vertex positions, one row a vertex [m].
    #[getter]
    fn vertices_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.hull.positions)
    }

    /// Corners of each triangle, counter-clockwise seen from outside.
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

    /// Volume inside; of an open hull it means little [m3].
    #[getter]
    fn volume_m3(&self) -> f64 {
        self.report.volume
    }

    /// What is odd about the hull.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    fn __repr__(&self) -> String {
        let (vertices, triangles) = (self.hull.positions.len(), self.hull.triangles.len());
        format!("<kufe.Hull {vertices} vertices, {triangles} triangles>")
    }
}

fn tessellated(swept: Result<Swept, MeshError>, edge_length: f64) -> Result<Hull, MeshError> {
    let hull = tessellate(&swept?, edge_length)?;
    let report = check_hull(&hull)?;
    Ok(Hull { hull, report })
}

fn rows<'py, T: numpy::Element + Copy>(
    py: Python<'py>,
    rows: &[[T; 3]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), 3])
}
