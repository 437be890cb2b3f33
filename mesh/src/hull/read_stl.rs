//! Hulls from STL files.

use crate::error::MeshError;
use crate::hull::text::{decode, lines, point, syntax, unreadable};
use crate::hull::triangles::{Axis, Hull, HullOptions};

/// Bytes of a binary STL's header with its number of facets.
const HEADER: usize = 84;
/// Bytes of a facet in a binary STL.
const FACET: usize = 50;

/// Reads an STL file, binary or text. Normals are taken from the order of the corners.
///
/// A file is binary if it has the bytes that its number of facets needs, even if its header begins
/// with `solid`; bytes after the last facet are ignored. Otherwise it is text if it begins with the
/// word `solid` in any case.
///
/// # Errors
/// [`MeshError::Value`] with the line of a text file, [`MeshError::Invalid`] if a binary file is
/// shorter than its number of facets needs, and those of a hull without triangles or with positions
/// that are not finite.
pub fn read_stl(bytes: &[u8], options: &HullOptions) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Z)?;
    let positions = match announced(bytes) {
        Some((facets, needed)) => {
            if needed <= bytes.len() as u64 {
                binary_corners(bytes, facets as usize)
            } else if is_text(bytes) {
                text_corners(bytes)?
            } else {
                return Err(MeshError::Invalid(format!(
                    "the STL file announces {facets} facets, which need {needed} bytes; it has {}",
                    bytes.len()
                )));
            }
        }
        None => text_corners(bytes)?,
    };
    let triangles = (0..positions.len() / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Hull::welded(&positions, triangles, rows)
}

/// The facets that the header of a binary file announces, and the bytes that they need.
fn announced(bytes: &[u8]) -> Option<(u64, u64)> {
    let [.., a, b, c, d] = bytes.first_chunk::<HEADER>()?;
    let facets = u64::from(u32::from_le_bytes([*a, *b, *c, *d]));
    Some((facets, facets * FACET as u64 + HEADER as u64))
}

/// That a binary file holds whole facets after those that it announces.
pub(crate) fn facets_left_over(bytes: &[u8]) -> Option<String> {
    let (facets, needed) = announced(bytes)?;
    let left_over = (bytes.len() as u64).checked_sub(needed)? / FACET as u64;
    (left_over > 0).then(|| {
        format!(
            "the STL file announces {facets} facets and has bytes for {left_over} more, which are \
             not read"
        )
    })
}

/// Whether the file begins with `solid` and has no zero bytes near its beginning, as the numbers of
/// a binary file do.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let word = start.trim_ascii_start().get(..5).unwrap_or_default();
    word.eq_ignore_ascii_case(b"solid") && !bytes.iter().take(1024).any(|&byte| byte == 0)
}

/// The corners of the facets of a binary file, three a facet.
fn binary_corners(bytes: &[u8], facets: usize) -> Vec<[f64; 3]> {
    let single = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let corner = |b: &[u8]| [single(b), single(&b[4..]), single(&b[8..])];
    let facets = bytes[HEADER..].chunks_exact(FACET).take(facets);
    facets
        .flat_map(|facet| facet[12..48].chunks_exact(12).map(corner))
        .collect()
}

/// The corners of the facets of a text file, three a facet.
fn text_corners(bytes: &[u8]) -> Result<Vec<[f64; 3]>, MeshError> {
    let text = decode(bytes);
    let mut positions = Vec::new();
    let mut in_solid = false;
    let mut corners: Option<usize> = None;
    let mut last = 1;
    for (line, content) in lines(&text) {
        let refuse = |word, expected| Err(syntax("STL", line, word, expected));
        let mut words = content.split_ascii_whitespace();
        while let Some(word) = words.next() {
            last = line;
            match (word.to_ascii_lowercase().as_str(), corners) {
                // The rest of the line is the solid's name.
                ("solid", None) if !in_solid => {
                    in_solid = true;
                    break;
                }
                ("endsolid", None) if in_solid => {
                    in_solid = false;
                    break;
                }
                ("facet", None) if in_solid => corners = Some(0),
                ("normal", Some(0)) => words.by_ref().take(3).for_each(drop),
                ("outer" | "loop" | "endloop", Some(_)) => {}
                ("vertex", Some(n)) if n < 3 => {
                    positions.push(point("STL", line, words.by_ref())?);
                    corners = Some(n + 1);
                }
                ("endfacet", Some(3)) => corners = None,
                (_, Some(3)) => return refuse(word, "endfacet after three vertices"),
                (_, Some(_)) => return refuse(word, "vertex"),
                (_, None) if in_solid => return refuse(word, "facet or endsolid"),
                (_, None) => return refuse(word, "solid"),
            }
        }
    }
    if in_solid || text.trim_ascii().is_empty() {
        let expected = if in_solid { "endsolid" } else { "solid" };
        let place = format!("line {last}");
        return Err(unreadable("STL", place, "the end of the file", expected));
    }
    Ok(positions)
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

    fn read(bytes: &[u8]) -> Result<Hull, MeshError> {
        read_stl(bytes, &HullOptions::default())
    }

    #[test]
    fn facets_after_the_announced_ones_are_told() {
        let mut bytes = binary(b"", 1, 3);
        assert!(facets_left_over(&bytes).unwrap().contains("for 2 more"));
        bytes.truncate(HEADER + 2 * FACET - 1);
        assert_eq!(facets_left_over(&bytes), None);
        assert_eq!(facets_left_over(TEXT.repeat(9).as_bytes()), None);
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        for (text, parts) in [
            ("", ["line 1", "end of the file"]),
            ("solid s\nendsolid s\n", ["no triangles", ""]),
            (&TEXT.replace("vertex 1", "vertex nan"), ["NaN", ""]),
            (
                &TEXT.replace("vertex 1 0", "vertex 1,5 0"),
                ["line 5", "not a comma"],
            ),
            (
                &TEXT.replace("vertex 1 0 0", "vertex 1 0"),
                ["line 5", "end of the line"],
            ),
            (
                &TEXT.replace("vertex 1 0 0", "vertex 1 x 0"),
                ["line 5", "\"x\""],
            ),
            (
                &TEXT.replace("vertex 1 0 0\n", ""),
                ["line 7", "found \"endfacet\"; expected vertex"],
            ),
            (
                &TEXT.replace("endloop", "vertex 1 1 1"),
                ["line 7", "three vertices"],
            ),
            (
                &TEXT.replace("endfacet\n", ""),
                ["line 8", "expected endfacet"],
            ),
            (
                &TEXT.replace("endsolid s\n", ""),
                ["line 8", "expected endsolid"],
            ),
            ("bolid", ["line 1", "expected solid"]),
        ] {
            let message = read(text.as_bytes()).unwrap_err().to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        }
        let refused = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(refused(&binary(b"", u32::MAX, 1)).contains("4294967295 facets"));
        assert!(refused(&binary(b"solid", 2, 1)).contains("2 facets"));
        assert!(refused(&binary(b"", 0, 0)).contains("no triangles"));
        let mut nan = binary(b"", 1, 1);
        nan[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(refused(&nan).contains("NaN"));
    }
}
