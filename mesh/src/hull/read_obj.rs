//! Hulls from Wavefront OBJ files.

use crate::error::MeshError;
use crate::hull::axes::{Axis, HullOptions};
use crate::hull::triangles::Hull;

/// Reads the triangles and polygons of an OBJ file; materials are ignored.
///
/// # Errors
/// [`MeshError::Obj`] where the file cannot be parsed, and those of a hull without triangles or
/// with positions that are no numbers.
pub fn read_obj(bytes: &[u8], options: &HullOptions) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Z)?;
    let load = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let without_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &load, without_materials)?;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for model in models {
        let first = positions.len();
        positions.extend(
            model
                .mesh
                .positions
                .chunks_exact(3)
                .map(|p| [p[0], p[1], p[2]]),
        );
        let corners = |t: &[u32]| [t[0], t[1], t[2]].map(|i| first + i as usize);
        triangles.extend(model.mesh.indices.chunks_exact(3).map(corners));
    }
    Hull::welded(&positions, triangles.into_iter(), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Hull, MeshError> {
        read_obj(text.as_bytes(), &HullOptions::default())
    }

    #[test]
    fn quads_negative_indices_and_objects_are_read() {
        let text = "# comment\nmtllib no.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl steel\nf 1/1/1 2 3 4\n\
                    o two\nv 0 0 1e-3\nf -1 -3 -2\n";
        let hull = read(text).unwrap();
        assert_eq!((hull.positions.len(), hull.triangles.len()), (5, 3));
        let scaled = read_obj(
            text.as_bytes(),
            &HullOptions {
                scale: 0.001,
                ..Default::default()
            },
        )
        .unwrap();
        assert_eq!(scaled.bounds()[1], [0.001, 0.001, 1e-6]);
    }

    #[test]
    fn coordinates_keep_double_precision() {
        let hull = read("v 0.123456789012 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(hull.positions[0][0], 0.123456789012);
    }

    #[test]
    fn broken_files_are_refused() {
        for (text, part) in [
            ("", "no triangles"),
            ("v 0 0 0\n", "no triangles"),
            ("v 0 0 0\nv 1 0 0\nf 1 2 9\n", "out of bounds"),
            ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "out of bounds"),
            ("v 0 zero 0\n", "position"),
            ("v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "NaN"),
            ("v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "inf"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text:?}: {message}");
        }
    }
}
