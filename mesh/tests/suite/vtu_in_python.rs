//! VTU and PVD files as pyvista and meshio read them, and VTU and Gmsh files as those write them.

use std::{path::Path, process::Command};

use kufe_mesh::{HexMesh, TensorGrid, VtuField, read_gmsh, read_vtu, write_pvd, write_vtu};

/// Runs `script` with the interpreter that KUFE_PYTHON names; none where that or `modules` are
/// missing.
fn python(script: &str, modules: &str, folder: &Path) -> Option<String> {
    let interpreter = kufe_outside::python(modules)?;
    let run = |code: &str| {
        Command::new(&interpreter)
            .arg("-c")
            .arg(code)
            .arg(env!("CARGO_PKG_VERSION"))
            .current_dir(folder)
            .output()
    };
    let out = run(script).unwrap();
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    Some(String::from_utf8(out.stdout).unwrap())
}

fn mesh(shape: [usize; 3]) -> HexMesh {
    let axis = |n: usize| (0..n).map(|i| 0.1 * (i * i) as f64).collect::<Vec<_>>();
    TensorGrid {
        x: axis(shape[0]),
        y: axis(shape[1]),
        z: axis(shape[2]),
    }
    .hex_mesh()
}

/// Writes `mesh` with a scalar, a vector and a tensor on points and a scalar on cells, all
/// functions of place.
fn write_with_fields(mesh: &HexMesh, path: &Path) {
    let scalar: Vec<f64> = mesh
        .points
        .iter()
        .map(|p| p[0] + 10.0 * p[1] + 100.0 * p[2])
        .collect();
    let vector: Vec<f64> = mesh
        .points
        .iter()
        .flat_map(|p| [p[2], p[0], p[1]])
        .collect();
    let tensor: Vec<f64> = mesh
        .points
        .iter()
        .flat_map(|p| (0..9).map(move |k| f64::from(k) * p[0]))
        .collect();
    let cell: Vec<f64> = (0..mesh.cells.len()).map(|i| i as f64 / 3.0).collect();
    let field = |name, components, values| VtuField {
        name,
        components,
        values,
    };
    write_vtu(
        mesh,
        &[
            field("von_mises_pa", 1, &scalar),
            field("displacement_m", 3, &vector),
            field("stress_pa", 9, &tensor),
        ],
        &[field("number", 1, &cell)],
        &[("planes", &[1.0, 0.0])],
        std::fs::File::create(path).unwrap(),
    )
    .unwrap();
}

#[test]
fn pyvista_and_meshio_read_points_cells_and_fields() {
    let folder = tempfile::tempdir().unwrap();
    // Whole blocks of the compressor, and not.
    for shape in [[16, 16, 16], [7, 5, 3]] {
        let mesh = mesh(shape);
        write_with_fields(&mesh, &folder.path().join("field.vtu"));
        let script = r#"
import sys, numpy as np, pyvista, meshio
def check(points, cells, scalar, vector, tensor, number):
    assert points.dtype == np.float64 and scalar.dtype == np.float32
    assert np.allclose(scalar, points @ [1, 10, 100], rtol=1e-7)
    assert np.array_equal(vector, np.float32(points[:, [2, 0, 1]]))
    assert np.array_equal(tensor.reshape(-1, 9), np.float32(np.outer(points[:, 0], np.arange(9))))
    assert np.array_equal(number, np.float32(np.arange(len(cells)) / 3))
m = meshio.read("field.vtu")
cells = m.cells_dict["hexahedron"]
check(m.points, cells, m.point_data["von_mises_pa"], m.point_data["displacement_m"], m.point_data["stress_pa"], m.cell_data["number"][0])
p = pyvista.read("field.vtu")
assert (p.celltypes == 12).all()
assert sys.argv[1] == ".".join(str(int(n)) for n in m.field_data["kufe_version"]) == ".".join(str(int(n)) for n in p.field_data["kufe_version"])
assert list(m.field_data["planes"]) == [1, 0] and list(p.field_data["planes"]) == [1, 0]
check(p.points, cells, p.point_data["von_mises_pa"], p.point_data["displacement_m"], p.point_data["stress_pa"], p.cell_data["number"])
print(len(m.points), len(cells), p.n_cells, p.volume)
"#;
        let Some(out) = python(script, "numpy, pyvista, meshio", folder.path()) else {
            return;
        };
        let words: Vec<f64> = out.split_whitespace().map(|w| w.parse().unwrap()).collect();
        assert_eq!(
            words[..3],
            [
                mesh.points.len() as f64,
                mesh.cells.len() as f64,
                mesh.cells.len() as f64
            ]
        );
        assert!((words[3] / mesh.quality().volume - 1.0).abs() < 1e-12);
    }
}

#[test]
fn pyvista_reads_a_series() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a & b.vtu", "c.vtu"] {
        write_with_fields(&mesh([3, 3, 3]), &folder.path().join(name));
    }
    let file = std::fs::File::create(folder.path().join("series.pvd")).unwrap();
    write_pvd(&[(250.0, "a & b.vtu"), (1000.0, "c.vtu")], file).unwrap();
    let script = r#"
import pyvista
reader = pyvista.get_reader("series.pvd")
print(reader.time_values)
reader.set_active_time_value(1000.0)
print(reader.read()[0].n_points)
"#;
    let Some(out) = python(script, "pyvista", folder.path()) else {
        return;
    };
    assert_eq!(out, "[250.0, 1000.0]\n27\n");
}

#[test]
fn files_written_by_pyvista_and_meshio_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh([9, 8, 7]);
    write_with_fields(&mesh, &folder.path().join("field.vtu"));
    let script = r#"
import pyvista, meshio
p = pyvista.read("field.vtu")
p.save("appended.vtu")
p.save("text.vtu", binary=False)
import vtk
for mode, name in ((vtk.vtkXMLWriter.Binary, "inline.vtu"), (vtk.vtkXMLWriter.Appended, "raw.vtu")):
    w = vtk.vtkXMLUnstructuredGridWriter()
    w.SetInputData(p); w.SetFileName(name); w.SetDataMode(mode)
    if name == "raw.vtu":
        w.EncodeAppendedDataOff(); w.SetCompressorTypeToNone()
    w.Write()
m = meshio.read("field.vtu")
# Unsigned nodes next to signed tags would become floating-point numbers in meshio's Gmsh writer.
m = meshio.Mesh(m.points, [("hexahedron", m.cells_dict["hexahedron"].astype("int64"))])
m.write("meshio.vtu")
meshio.write("two.msh", m, file_format="gmsh22", binary=False)
meshio.write("four.msh", m, file_format="gmsh", binary=False)
"#;
    if python(script, "pyvista, meshio, vtk", folder.path()).is_none() {
        return;
    }
    for name in [
        "appended.vtu",
        "text.vtu",
        "inline.vtu",
        "raw.vtu",
        "meshio.vtu",
        "two.msh",
        "four.msh",
    ] {
        let bytes = std::fs::read(folder.path().join(name)).unwrap();
        let back = if name.ends_with("vtu") {
            read_vtu(&bytes)
        } else {
            read_gmsh(&bytes)
        };
        let back = back.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(
            (back.points.len(), back.cells.len()),
            (mesh.points.len(), mesh.cells.len()),
            "{name}"
        );
        // Text formats keep about ten digits.
        assert!(
            (back.quality().volume / mesh.quality().volume - 1.0).abs() < 1e-7,
            "{name}"
        );
    }
}
