//! Which nodes share a cell: the pattern of the stiffness matrix.

use kufe_mesh::HexMesh;
use rayon::prelude::*;

use crate::sparse::node_cells::NodeCells;

/// Neighbours and cells of every node, by rows, each row ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeGraph {
    /// Start of each node's neighbours; `node_count + 1` entries.
    pub row_start: Vec<usize>,
    /// Neighbouring nodes, the node itself included.
    pub neighbours: Vec<u32>,
    /// The cells of every node.
    pub cells: NodeCells,
}

impl NodeGraph {
    /// The graph of a mesh whose cells name existing nodes, fewer than 2^32.
    pub fn new(mesh: &HexMesh) -> Self {
        let node_count = mesh.points.len();
        let cells = NodeCells::new(mesh);
        const BATCH: usize = 1024;
        let batches: Vec<(Vec<u32>, Vec<u32>)> = (0..node_count.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                let (mut counts, mut all, mut row) = (Vec::new(), Vec::new(), Vec::new());
                for node in batch * BATCH..((batch + 1) * BATCH).min(node_count) {
                    row.clear();
                    for (cell, _) in cells.of(node) {
                        row.extend(mesh.cells[cell].iter().map(|&n| n as u32));
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
            cells,
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
