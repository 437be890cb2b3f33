//! Hulls in files, in the format of the file's ending.

use std::io::Write;
use std::path::{Path, PathBuf};

use kufe_files::read_regular;

use crate::error::MeshError;
use crate::hull::read_3mf::read_3mf;
use crate::hull::read_gltf::{outer_buffers, read_gltf};
use crate::hull::read_obj::read_obj;
use crate::hull::read_stl::{facets_left_over, read_stl};
use crate::hull::triangles::{Hull, HullOptions, HullReport, checked_runner};
use crate::hull::write::{write_glb, write_obj, write_stl};
use crate::input::{ending, read_file};

/// Largest size of a file that belongs to a hull [bytes].
const MAX_BYTES: u64 = 1 << 31;

/// The formats that hulls are read from and written to; 3MF is read only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HullFormat {
    /// Wavefront OBJ.
    Obj,
    /// glTF, text or binary.
    Gltf,
    /// STL, text or binary.
    Stl,
}

impl HullFormat {
    /// The format that the ending of `path` names.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] for an unknown ending.
    pub fn of(path: &Path) -> Result<Self, MeshError> {
        match ending(path).as_str() {
            "obj" => Ok(Self::Obj),
            "gltf" | "glb" => Ok(Self::Gltf),
            "stl" => Ok(Self::Stl),
            found => Err(MeshError::Invalid(format!(
                "the ending {found:?}: expected obj, gltf, glb or stl, or to read a hull 3mf"
            ))),
        }
    }

    /// The format that the ending of an output file names; glTF is written as `.glb`.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] for `.gltf` and unknown endings.
    pub fn of_output(path: &Path) -> Result<Self, MeshError> {
        match (Self::of(path)?, ending(path).as_str()) {
            (_, "gltf") => Err(MeshError::Invalid(
                "the ending \"gltf\": expected obj, glb or stl to write a hull".into(),
            )),
            (format, _) => Ok(format),
        }
    }

    /// Writes `hull` in this format; glTF is written as GLB.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(self, hull: &Hull, writer: impl Write) -> std::io::Result<()> {
        match self {
            Self::Obj => write_obj(hull, writer),
            Self::Gltf => write_glb(hull, writer),
            Self::Stl => write_stl(hull, writer),
        }
    }
}

/// Reads the hull file `path` and checks its most extended body.
///
/// # Errors
/// [`MeshError::Io`] if the file cannot be read, [`MeshError::File`] if its content is invalid.
pub fn load_hull(path: &Path, options: &HullOptions) -> Result<(Hull, HullReport), MeshError> {
    let in_file = |error: MeshError| error.in_file(path);
    let format = match ending(path).as_str() {
        "3mf" => None,
        "step" | "stp" | "iges" | "igs" => return Err(in_file(exact_shape(path))),
        "ply" | "off" => return Err(in_file(other_triangles(path))),
        _ => Some(HullFormat::of(path).map_err(in_file)?),
    };
    let bytes = read_file(path, MAX_BYTES)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let hull = match format {
        None => read_3mf(&bytes, options),
        Some(HullFormat::Obj) => read_obj(&bytes, options),
        Some(HullFormat::Stl) => read_stl(&bytes, options),
        Some(HullFormat::Gltf) => read_gltf(&bytes, options, |uri| {
            read_regular(&folder.join(uri), MAX_BYTES)
        }),
    };
    let (hull, mut report) = hull.and_then(checked_runner).map_err(in_file)?;
    if format == Some(HullFormat::Stl) {
        let left_over = facets_left_over(&bytes);
        report.removed.extend(left_over.clone());
        report.warnings.extend(left_over);
    }
    Ok((hull, report))
}

/// The error of a triangle format that is not read, with the command that converts it.
fn other_triangles(path: &Path) -> MeshError {
    MeshError::Invalid(format!(
        "the format is not read: expected obj, gltf, glb, stl or 3mf; `meshio convert {} {}` \
         converts it",
        path.display(),
        path.with_extension("stl").display()
    ))
}

/// The error of a CAD file of exact shapes, with the command that triangulates them.
fn exact_shape(path: &Path) -> MeshError {
    MeshError::Invalid(format!(
        "the file holds exact shapes, and hulls are read as triangles: expected obj, gltf, glb, stl \
         or 3mf; `gmsh {} -2 -clmax 0.5 -format stl -bin -o {}` makes triangles of 0.5 mm of it, in \
         millimetres (scale = 0.001)",
        path.display(),
        path.with_extension("stl").display()
    ))
}

/// The files that a hull consists of: `path`, and the buffers of a glTF file in files of their own.
///
/// # Errors
/// As [`load_hull`], as far as the file is read.
pub fn hull_files(path: &Path) -> Result<Vec<PathBuf>, MeshError> {
    let mut files = vec![path.to_path_buf()];
    if HullFormat::of(path).is_ok_and(|format| format == HullFormat::Gltf) {
        let bytes = read_file(path, MAX_BYTES)?;
        let buffers = outer_buffers(&bytes).map_err(|error| error.in_file(path))?;
        let folder = path.parent().unwrap_or(Path::new("."));
        files.extend(buffers.iter().map(|uri| folder.join(uri)));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::tessellate::tessellate;
    use crate::shapes::swept::BobRunner;

    #[test]
    fn every_format_gives_back_the_hull_that_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let hull = tessellate(&BobRunner::default().swept().unwrap(), 0.004).unwrap();
        for (name, tolerance) in [("bob.obj", 0.0), ("bob.glb", 3e-8), ("bob.stl", 3e-8)] {
            let path = folder.path().join(name);
            let format = HullFormat::of(&path).unwrap();
            format
                .write(&hull, std::fs::File::create(&path).unwrap())
                .unwrap();
            let (back, report) = load_hull(&path, &HullOptions::default()).unwrap();
            assert_eq!(
                (
                    report.open_edges,
                    report.flipped_edges,
                    report.warnings.len()
                ),
                (0, 0, 0),
                "{name}"
            );
            assert_eq!(back.triangles.len(), hull.triangles.len());
            for (t, u) in back.triangles.iter().zip(&hull.triangles) {
                for (&i, &j) in t.iter().zip(u) {
                    let (p, q) = (back.positions[i as usize], hull.positions[j as usize]);
                    assert!(
                        (0..3).all(|k| (p[k] - q[k]).abs() <= tolerance),
                        "{name}: {p:?} {q:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("empty.obj");
        let message = |path: &Path| {
            load_hull(path, &HullOptions::default())
                .unwrap_err()
                .to_string()
        };
        assert!(message(&path).contains("empty.obj"));
        std::fs::write(&path, "").unwrap();
        assert!(message(&path).contains("empty.obj: the hull has no triangles"));
        assert!(message(Path::new("bob.xyz")).contains("\"xyz\""));
        assert!(message(Path::new("bob.ply")).contains("`meshio convert bob.ply bob.stl`"));
        for name in ["of/bob.STEP", "of/bob.stp", "of/bob.iges", "of/bob.igs"] {
            let refusal = message(Path::new(name));
            assert!(refusal.contains(&format!("`gmsh {name} -2 ")), "{refusal}");
            assert!(refusal.contains("-o of/bob.stl`") && refusal.contains("scale = 0.001"));
        }
    }
}
