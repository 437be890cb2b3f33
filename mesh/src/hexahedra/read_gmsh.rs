//! Hexahedral meshes from Gmsh files.

use std::collections::HashMap;
use std::fmt::Display;

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::{HexMesh, cell_type};
use crate::hull::text::unreadable;

/// Gmsh's number for an eight-node hexahedron.
const HEXAHEDRON: u64 = 5;
/// Numbers of nodes of Gmsh's element types that may occur together with hexahedra: lines,
/// triangles, quadrangles, points.
const LOWER_DIMENSIONS: [(u64, usize); 8] = [
    (1, 2),
    (2, 3),
    (3, 4),
    (8, 3),
    (9, 6),
    (10, 9),
    (15, 1),
    (16, 8),
];

/// Reads the hexahedra of a Gmsh file in text format, version 2.2 or 4.1. Points, lines and faces
/// are ignored.
///
/// # Errors
/// [`MeshError::Value`] with the line and what was expected, [`MeshError::Invalid`] for other solid
/// elements, and those of [`HexMesh::checked`].
pub fn read_gmsh(bytes: &[u8]) -> Result<HexMesh, MeshError> {
    let mut words = Words::of(bytes)?;
    words.section("$MeshFormat")?;
    let version: f64 = words.next("the format's version")?;
    let binary: u64 = words.next("the file type")?;
    if binary != 0 {
        return Err(words.problem("1 for a binary file", "0, a file saved as text"));
    }
    let new = match version {
        2.2 => false,
        4.1 => true,
        _ => return Err(words.problem(version, "version 2.2 or 4.1")),
    };
    words.section("$Nodes")?;
    let (points, number) = nodes(&mut words, new)?;
    words.section("$Elements")?;
    let cells = elements(&mut words, new, &number)?;
    HexMesh::checked(&points, &cells)
}

/// Positions of the nodes, and the index of each node number.
type Nodes = (Vec<[f64; 3]>, HashMap<u64, usize>);

/// The nodes: one list in version 2.2, blocks of numbers and then places in version 4.1.
fn nodes(words: &mut Words, new: bool) -> Result<Nodes, MeshError> {
    let (mut points, mut number) = (Vec::new(), HashMap::new());
    for _ in 0..words.blocks(new)? {
        if new {
            words.skip(2)?;
            let parametric: u64 = words.next("0 or 1")?;
            if parametric != 0 {
                return Err(words.problem("1", "0, nodes without parametric coordinates"));
            }
        }
        let count: usize = words.next("the number of nodes")?;
        let first = points.len();
        for i in 0..count {
            number.insert(words.next("a node's number")?, first + i);
            if !new {
                points.push(words.position()?);
            }
        }
        if new {
            for _ in 0..count {
                points.push(words.position()?);
            }
        }
    }
    Ok((points, number))
}

/// The hexahedra: one list in version 2.2, blocks of one type in version 4.1.
fn elements(
    words: &mut Words,
    new: bool,
    number: &HashMap<u64, usize>,
) -> Result<Vec<[usize; 8]>, MeshError> {
    let mut cells = Vec::new();
    let mut element = 0;
    for _ in 0..words.blocks(new)? {
        let mut kind: u64 = 0;
        if new {
            words.skip(2)?;
            kind = words.next("an element's type")?;
        }
        let count: usize = words.next("the number of elements")?;
        for _ in 0..count {
            words.skip(1)?;
            if !new {
                kind = words.next("an element's type")?;
                let tags: usize = words.next("the number of tags")?;
                words.skip(tags)?;
            }
            words.element(element, kind, number, &mut cells)?;
            element += 1;
        }
    }
    Ok(cells)
}

fn gmsh_error(line: usize, found: impl Display, expected: &str) -> MeshError {
    unreadable("Gmsh", format!("line {line}"), found, expected)
}

/// The words of a text with their lines.
struct Words<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
}

impl<'a> Words<'a> {
    fn of(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let text = str::from_utf8(bytes).map_err(|error| {
            let before = &bytes[..error.valid_up_to()];
            let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
            let expected = "a Gmsh file saved as text";
            gmsh_error(line, "bytes that are no text", expected)
        })?;
        let lines = text.lines().enumerate();
        let words = |(i, line): (usize, &'a str)| line.split_whitespace().map(move |w| (i + 1, w));
        Ok(Self {
            words: Box::new(lines.flat_map(words)),
            line: 1,
        })
    }

    fn problem(&self, found: impl Display, expected: &str) -> MeshError {
        gmsh_error(self.line, found, expected)
    }

    fn word(&mut self, expected: &str) -> Result<&'a str, MeshError> {
        let next = self.words.next();
        let (line, word) = next.ok_or_else(|| self.problem("the end of the file", expected))?;
        self.line = line;
        Ok(word)
    }

    fn next<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, MeshError> {
        let word = self.word(expected)?;
        word.parse()
            .map_err(|_| self.problem(word.chars().take(40).collect::<String>(), expected))
    }

    fn skip(&mut self, count: usize) -> Result<(), MeshError> {
        (0..count).try_for_each(|_| self.word("a number").map(|_| ()))
    }

    /// The number of blocks of a section; one in version 2.2, which states none.
    fn blocks(&mut self, new: bool) -> Result<usize, MeshError> {
        if !new {
            return Ok(1);
        }
        let blocks = self.next("the number of blocks")?;
        self.skip(3)?;
        Ok(blocks)
    }

    fn position(&mut self) -> Result<[f64; 3], MeshError> {
        let mut coordinate = || self.next("a coordinate");
        Ok([coordinate()?, coordinate()?, coordinate()?])
    }

    /// Skips the words up to and including `name`.
    fn section(&mut self, name: &str) -> Result<(), MeshError> {
        while self.word(name)? != name {}
        Ok(())
    }

    fn element(
        &mut self,
        element: usize,
        kind: u64,
        number: &HashMap<u64, usize>,
        cells: &mut Vec<[usize; 8]>,
    ) -> Result<(), MeshError> {
        if let Some((_, nodes)) = LOWER_DIMENSIONS.iter().find(|(other, _)| *other == kind) {
            return self.skip(*nodes);
        }
        if kind != HEXAHEDRON {
            return Err(cell_type(element, "Gmsh", kind));
        }
        let mut cell = [0; 8];
        for corner in &mut cell {
            let node: u64 = self.next("a node's number")?;
            *corner = *number
                .get(&node)
                .ok_or_else(|| self.problem(node, "the number of a node in $Nodes"))?;
        }
        cells.push(cell);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: &str =
        "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n15 0 0 2\n16 1 0 2\n17 1 1 2\n18 0 1 2\n";

    fn version_2(elements: &str) -> String {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n{NODES}$EndNodes\n$Elements\n{elements}\n$EndElements\n"
        )
    }

    #[test]
    fn both_versions_give_the_hexahedron_and_pass_over_faces() {
        let two =
            read_gmsh(version_2("2\n1 3 2 1 1 1 2 3 4\n2 5 2 1 1 1 2 3 4 15 16 17 18").as_bytes())
                .unwrap();
        assert!((two.quality().volume - 2.0).abs() < 1e-15);
        let tags = "1\n2\n3\n4\n15\n16\n17\n18\n";
        let places = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n";
        let four = format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n$EndEntities\n$Nodes\n1 8 1 18\n3 1 0 8\n{tags}{places}\
             $EndNodes\n$Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n3 1 5 1\n2 1 2 3 4 15 16 17 18\n$EndElements\n"
        );
        assert_eq!(read_gmsh(four.as_bytes()).unwrap(), two);
        let upside_down =
            read_gmsh(version_2("1\n2 5 2 1 1 15 16 17 18 1 2 3 4").as_bytes()).unwrap();
        assert_eq!(upside_down.quality().inverted, 0);
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        let refused = |text: &str| read_gmsh(text.as_bytes()).unwrap_err().to_string();
        assert!(refused("").contains("$MeshFormat"));
        assert!(refused("$MeshFormat\n2.2 1 8").contains("line 2"));
        assert!(refused("$MeshFormat\n3.0 0 8").contains("2.2 or 4.1"));
        assert!(refused(&version_2("1\n1 4 0 1 2 3 4")).contains("Gmsh type 4"));
        assert!(refused(&version_2("1\n1 5 0 1 2 3 4 5 6 7 8")).contains("line 17"));
        assert!(
            refused(&version_2(
                "18446744073709551615\n1 5 0 1 2 3 4 15 16 17 18"
            ))
            .contains("expected")
        );
        assert!(refused(&version_2("0")).contains("no hexahedra"));
        assert!(
            refused(&version_2("1\n1 5 0 1 2 3 4 15 16 17 18").replace("1 1 2\n", "1 one 2\n"))
                .contains("one")
        );
        assert!(
            read_gmsh(b"$MeshFormat\n2.2 0 \xff")
                .unwrap_err()
                .to_string()
                .contains("line 2")
        );
    }
}
