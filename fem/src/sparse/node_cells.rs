//! The cells in which each node stands.

use kufe_mesh::HexMesh;

/// Cells and corners of every node, by rows, cells ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeCells {
    /// Start of each node's places; one entry more than there are nodes.
    pub start: Vec<usize>,
    /// Each node's places in cells, as 8 * cell + corner.
    pub places: Vec<u64>,
}

impl NodeCells {
    /// The cells of a mesh, which name existing nodes.
    pub fn new(mesh: &HexMesh) -> Self {
        let node_count = mesh.points.len();
        let mut start = vec![0usize; node_count + 1];
        for &node in mesh.cells.iter().flatten() {
            start[node + 1] += 1;
        }
        for i in 0..node_count {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut places = vec![0u64; 8 * mesh.cells.len()];
        for (cell, corners) in mesh.cells.iter().enumerate() {
            for (corner, &node) in corners.iter().enumerate() {
                places[next[node]] = (8 * cell + corner) as u64;
                next[node] += 1;
            }
        }
        Self { start, places }
    }

    /// The (cell, corner) pairs in which a node stands, cells ascending.
    pub fn of(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.places[self.start[node]..self.start[node + 1]]
            .iter()
            .map(|&place| ((place / 8) as usize, (place % 8) as usize))
    }
}
