//! Hulls from STL files.

use std::io::Cursor;

use crate::error::MeshError;
use crate::hull::axes::{Axis, HullOptions};
use crate::hull::triangles::Hull;

/// Bytes of a binary STL's header, and of each of its facets.
const HEADER: usize = 84;
const FACET: usize = 50;

/// Reads an STL file, binary or text. Normals are taken from the order of the corners.
///
/// # Errors
/// [`MeshError::Stl`] where the file cannot be parsed, [`MeshError::StlLength`] where a binary file
/// does not hold the facets that it announces, and those of a hull without triangles or with
/// positions that are no numbers.
pub fn read_stl(bytes: &[u8], options: &HullOptions) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Z)?;
    let announced = bytes
        .get(80..HEADER)
        .map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let needed = announced.map(|n| n * FACET as u64 + HEADER as u64);
    let is_text = bytes.starts_with(b"solid ") && needed != Some(bytes.len() as u64);
    if !is_text
        && let (Some(facets), Some(needed)) = (announced, needed)
        && needed > bytes.len() as u64
    {
        return Err(MeshError::StlLength {
            facets,
            needed,
            found: bytes.len(),
        });
    }
    let mesh = if !is_text && bytes.starts_with(b"solid ") {
        // The text probe looks at the first word, which some binary writers start with too.
        let mut copy = bytes.to_vec();
        copy[0] = b'_';
        stl_io::read_stl(&mut Cursor::new(copy))?
    } else {
        stl_io::read_stl(&mut Cursor::new(bytes))?
    };
    let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(|v| v.0.map(f64::from)).collect();
    Hull::welded(&positions, mesh.faces.iter().map(|f| f.vertices), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                        endloop\nendfacet\nendsolid s\n";

    fn binary(header: &[u8], announced: u32, facets: usize) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes[..header.len()].copy_from_slice(header);
        bytes.extend(announced.to_le_bytes());
        for _ in 0..facets {
            for value in [
                0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
            ] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_give_the_same_hull_even_with_a_header_that_says_solid() {
        let options = HullOptions::default();
        let text = read_stl(TEXT.as_bytes(), &options).unwrap();
        assert_eq!(text, read_stl(&binary(b"kufe", 1, 1), &options).unwrap());
        assert_eq!(
            text,
            read_stl(&binary(b"solid kufe", 1, 1), &options).unwrap()
        );
    }

    #[test]
    fn broken_files_are_refused() {
        let refused = |bytes: &[u8]| {
            read_stl(bytes, &HullOptions::default())
                .unwrap_err()
                .to_string()
        };
        assert!(refused(&binary(b"", u32::MAX, 1)).contains("4294967295 facets"));
        assert!(refused(&binary(b"", 0, 0)).contains("no triangles"));
        assert!(refused(b"solid s\nendsolid s\n").contains("no triangles"));
        assert!(refused(TEXT.replace("vertex 1", "vertex nan").as_bytes()).contains("STL"));
        assert!(refused(b"").contains("STL"));
        let mut nan = binary(b"", 1, 1);
        nan[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(refused(&nan).contains("NaN"));
    }
}
