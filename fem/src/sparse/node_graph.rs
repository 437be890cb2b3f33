//! Which nodes share a cell: the pattern of the stiffness matrix.

use kufe_mesh::HexMesh;
use rayon::prelude::*;

/// Neighbours and cells of every node, by rows, each row ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeGraph {
    /// Start of each node's neighbours; `node_count + 1` entries.
    pub row_start: Vec<usize>,
    /// Neighbouring nodes, the node itself included.
    pub neighbours: Vec<u32>,
    /// Start of each node's cells; `node_count + 1` entries.
    pub cell_start: Vec<usize>,
    /// Each node's places in cells, as 8 * cell + corner.
    pub places: Vec<u64>,
}

impl NodeGraph {
    /// The graph of a mesh whose cells name existing nodes, fewer than 2^32.
    pub fn new(mesh: &HexMesh) -> Self {
        let node_count = mesh.points.len();
        let mut cell_start = vec![0usize; node_count + 1];
        for &node in mesh.cells.iter().flatten() {
            cell_start[node + 1] += 1;
        }
        for i in 0..node_count {
            cell_start[i + 1] += cell_start[i];
        }
        let mut next = cell_start.clone();
        let mut places = vec![0u64; 8 * mesh.cells.len()];
        for (cell, corners) in mesh.cells.iter().enumerate() {
            for (corner, &node) in corners.iter().enumerate() {
                places[next[node]] = (8 * cell + corner) as u64;
                next[node] += 1;
            }
        }
        drop(next);

        const BATCH: usize = 1024;
        let batches: Vec<(Vec<u32>, Vec<u32>)> = (0..node_count.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let (mut counts, mut all, mut row) = (Vec::new(), Vec::new(), Vec::new());
                for node in batch * BATCH..((batch + 1) * BATCH).min(node_count) {
                    row.clear();
                    for place in &places[cell_start[node]..cell_start[node + 1]] {
                        row.extend(mesh.cells[(place / 8) as usize].iter().map(|&n| n as u32));
                    }
                    row.sort_unstable();
                    row.dedup();
                    counts.push(row.len() as u32);
                    all.extend_from_slice(&row);
                }
                (counts, all)
            })
            .collect();
        let mut row_start = Vec::with_capacity(node_count + 1);
        row_start.push(0);
        let mut neighbours = Vec::with_capacity(batches.iter().map(|(_, all)| all.len()).sum());
        for (counts, all) in batches {
            for count in counts {
                row_start.push(row_start[row_start.len() - 1] + count as usize);
            }
            neighbours.extend(all);
        }
        Self {
            row_start,
            neighbours,
            cell_start,
            places,
        }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Neighbours of a node, itself included, ascending.
    pub fn row(&self, node: usize) -> &[u32] {
        &self.neighbours[self.row_start[node]..self.row_start[node + 1]]
    }

    /// The (cell, corner) pairs in which a node stands, cells ascending.
    pub fn cells(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.places[self.cell_start[node]..self.cell_start[node + 1]]
            .iter()
            .map(|&place| ((place / 8) as usize, (place % 8) as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_block::block;

    #[test]
    fn inner_nodes_of_a_block_have_27_neighbours_and_8_cells() {
        let graph = NodeGraph::new(&block([4, 3, 3], [1.0; 3], 0.0));
        let counts: Vec<usize> = (0..graph.node_count())
            .map(|n| graph.row(n).len())
            .collect();
        assert_eq!(counts.iter().filter(|&&c| c == 27).count(), 3 * 2 * 2);
        assert_eq!(counts.iter().filter(|&&c| c == 8).count(), 8);
        assert_eq!(
            counts.iter().sum::<usize>(),
            (3 * 5 - 2) * (3 * 4 - 2) * (3 * 4 - 2)
        );
        for node in 0..graph.node_count() {
            assert!(graph.row(node).windows(2).all(|w| w[0] < w[1]));
            for &other in graph.row(node) {
                assert!(graph.row(other as usize).contains(&(node as u32)));
            }
        }
    }
}
