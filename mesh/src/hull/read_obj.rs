//! Hulls from Wavefront OBJ files.

use crate::error::MeshError;
use crate::hull::text::{decode, lines, point, syntax};
use crate::hull::triangles::{Axis, Hull, HullOptions};

/// Reads the triangles and polygons of an OBJ file.
///
/// Only `v` and `f` are read. Texture coordinates, normals, materials, groups, lines and points are
/// ignored. A negative index counts backwards from the last vertex above its line. Polygons are
/// split into triangles from their first corner.
///
/// # Errors
/// [`MeshError::Value`] with the line, and those of a hull without triangles or with positions
/// that are not finite.
pub fn read_obj(bytes: &[u8], options: &HullOptions) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Z)?;
    let text = decode(bytes);
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut triangles: Vec<[usize; 3]> = Vec::new();
    let mut corners: Vec<usize> = Vec::new();
    let mut lines = lines(&text);
    while let Some((number, mut line)) = lines.next() {
        let joined;
        if line.ends_with('\\') {
            joined = continued(line, &mut lines);
            line = &joined;
        }
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => positions.push(point("OBJ", number, words)?),
            Some("f") => {
                corners.clear();
                for word in words.take_while(|word| !word.starts_with('#')) {
                    let index = corner(word, positions.len());
                    let expected = "the number of a vertex, from 1 or backwards from -1";
                    corners.push(index.ok_or_else(|| syntax("OBJ", number, word, expected))?);
                }
                let pairs = corners.windows(2).skip(1);
                triangles.extend(pairs.map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Hull::welded(&positions, triangles.into_iter(), rows)
}

/// A line that ends with a backslash, with those that continue it.
fn continued<'a>(first: &str, lines: &mut impl Iterator<Item = (usize, &'a str)>) -> String {
    let mut joined = String::new();
    let mut line = Some(first);
    while let Some(part) = line {
        let end = part.strip_suffix('\\');
        joined.push_str(end.unwrap_or(part));
        joined.push(' ');
        line = end.and_then(|_| lines.next()).map(|(_, next)| next);
    }
    joined
}

/// The vertex, from 0, of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` on a line with `above`
/// vertices above it.
fn corner(word: &str, above: usize) -> Option<usize> {
    let index: i64 = word.split('/').next()?.parse().ok()?;
    if index < 0 {
        above.checked_sub(usize::try_from(index.unsigned_abs()).ok()?)
    } else {
        usize::try_from(index).ok()?.checked_sub(1)
    }
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
        let millimetres = HullOptions {
            scale: 0.001,
            ..Default::default()
        };
        let scaled = read_obj(text.as_bytes(), &millimetres).unwrap();
        assert_eq!(scaled.bounds()[1], [0.001, 0.001, 1e-6]);
    }

    /// Blocks of three vertices, each with a face that counts backwards from its own line.
    #[test]
    fn negative_indices_count_from_their_own_line() {
        let block = |z: f64| format!("v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nvn 0 0 1\n");
        let face = "f -3//-1 -2//-1 -1//-1\n";
        let hull = read(&format!("{}{face}{}{face}", block(0.0), block(5.0))).unwrap();
        let heights = |t: &[u32; 3]| t.map(|i| hull.positions[i as usize][2]);
        assert_eq!(heights(&hull.triangles[0]), [0.0; 3]);
        assert_eq!(heights(&hull.triangles[1]), [5.0; 3]);
        // The first block again, from the last of 200,000 vertices.
        let many = "v 0 0 9\n".repeat(199_997);
        let hull = read(&format!("{}{many}f -200000 -199999 -199998\n", block(2.0))).unwrap();
        assert_eq!(hull.positions[2], [0.0, 1.0, 2.0]);
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
            ("v 0 0 0\nv 1 0 0\nf 1 2 9\n", "refers to vertex 8"),
            (
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n",
                "line 4: found \"0\"",
            ),
            (
                "v 0 0 0\nf -1 -2 -3\nv 1 0 0\nv 0 1 0\n",
                "line 2: found \"-2\"",
            ),
            ("v 0 zero 0\n", "line 1: found \"zero\""),
            ("v 0 0\n", "line 1: found the end of the line"),
            (
                "v 0,5 1,0 0\n",
                "line 1: found \"0,5\"; expected a coordinate with a decimal point, not a comma",
            ),
            ("v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "NaN"),
            ("v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "inf"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text:?}: {message}");
        }
    }
}
