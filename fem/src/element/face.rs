//! The quadrilateral faces of hexahedra.

use std::collections::HashMap;

use kufe_mesh::HexMesh;

/// Corners of the six faces of a cell, counter-clockwise seen from outside: -x, +x, -y, +y, -z, +z
/// in natural coordinates.
pub const FACES: [[usize; 4]; 6] = [
    [0, 4, 7, 3],
    [1, 2, 6, 5],
    [0, 1, 5, 4],
    [3, 7, 6, 2],
    [0, 3, 2, 1],
    [4, 5, 6, 7],
];

/// The boundary faces, which belong to one cell only, as nodes counter-clockwise seen from outside,
/// in the order of the cells.
pub fn boundary_faces(mesh: &HexMesh) -> Vec<[usize; 4]> {
    let key = |mut face: [usize; 4]| {
        face.sort_unstable();
        face
    };
    let faces = || {
        mesh.cells
            .iter()
            .flat_map(|cell| FACES.map(|face| face.map(|corner| cell[corner])))
    };
    let mut count: HashMap<[usize; 4], u32> = HashMap::new();
    for face in faces() {
        *count.entry(key(face)).or_default() += 1;
    }
    faces().filter(|&face| count[&key(face)] == 1).collect()
}
