//! Sparse matrices of 3 x 3 blocks, one block for each pair of nodes that share a cell.

use std::sync::Arc;

use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use rayon::prelude::*;

use crate::constraints::DofMap;
use crate::sparse::node_graph::NodeGraph;

/// A symmetric sparse matrix of 3 x 3 blocks over the nodes of a mesh.
///
/// Two kilobytes a node for a hexahedral mesh, both triangles stored, so that rows can be applied in parallel with
/// the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    /// Which blocks there are.
    pub graph: Arc<NodeGraph>,
    /// The blocks by rows, as `graph.neighbours`; each 3 x 3 by rows.
    pub blocks: Vec<[[f64; 3]; 3]>,
}

/// Nodes whose rows are applied by one task.
const ROWS_A_TASK: usize = 256;

impl BlockMatrix {
    /// Number of rows, three a node.
    pub fn dofs(&self) -> usize {
        3 * self.graph.node_count()
    }

    /// `y` = K `u`; both hold [`BlockMatrix::dofs`] numbers.
    ///
    /// # Panics
    /// Where a vector has another length.
    pub fn apply(&self, u: &[f64], y: &mut [f64]) {
        assert_eq!((u.len(), y.len()), (self.dofs(), self.dofs()));
        y.par_chunks_mut(3 * ROWS_A_TASK)
            .enumerate()
            .for_each(|(task, y)| {
                for (local, y) in y.chunks_exact_mut(3).enumerate() {
                    let node = task * ROWS_A_TASK + local;
                    let range = self.graph.row_start[node]..self.graph.row_start[node + 1];
                    let mut sum = [0.0; 3];
                    for (block, &other) in self.blocks[range.clone()]
                        .iter()
                        .zip(&self.graph.neighbours[range])
                    {
                        let at = 3 * other as usize;
                        let v = &u[at..at + 3];
                        for i in 0..3 {
                            sum[i] += block[i][0] * v[0] + block[i][1] * v[1] + block[i][2] * v[2];
                        }
                    }
                    y.copy_from_slice(&sum);
                }
            });
    }

    /// The diagonal, [`BlockMatrix::dofs`] numbers.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.dofs()];
        for (node, d) in diagonal.chunks_exact_mut(3).enumerate() {
            let position = self.position(node, node as u32);
            for i in 0..3 {
                d[i] = self.blocks[position][i][i];
            }
        }
        diagonal
    }

    fn position(&self, node: usize, neighbour: u32) -> usize {
        let place = self.graph.row(node).binary_search(&neighbour);
        self.graph.row_start[node] + place.expect("nodes of one cell are neighbours")
    }

    /// The lower triangle over the free displacements of `map` as a faer matrix, diagonal included.
    ///
    /// Square, [`DofMap::free_count`] rows, columns and rows ascending; what a Cholesky factorisation reads.
    pub fn lower_free(&self, map: &DofMap) -> SparseColMat<u32, f64> {
        self.columns(map, true)
    }

    /// The whole matrix over the free displacements of `map` as a faer matrix.
    pub fn to_faer(&self, map: &DofMap) -> SparseColMat<u32, f64> {
        self.columns(map, false)
    }

    fn columns(&self, map: &DofMap, lower: bool) -> SparseColMat<u32, f64> {
        let n = map.free_count();
        // The matrix is symmetric, so a column's rows are read from the block row of its node.
        let entries = |column: usize| {
            let (node, c) = (
                map.free()[column] as usize / 3,
                map.free()[column] as usize % 3,
            );
            let range = self.graph.row_start[node]..self.graph.row_start[node + 1];
            range.flat_map(move |k| {
                let other = self.graph.neighbours[k] as usize;
                (0..3).filter_map(move |i| {
                    let row = map.index(3 * other + i)?;
                    (!lower || row >= column).then_some((row as u32, self.blocks[k][c][i]))
                })
            })
        };
        let counts: Vec<u32> = (0..n)
            .into_par_iter()
            .map(|j| entries(j).count() as u32)
            .collect();
        let mut column_start = vec![0u32; n + 1];
        for j in 0..n {
            column_start[j + 1] = column_start[j]
                .checked_add(counts[j])
                .expect("fewer than 2^32 entries");
        }
        let mut rows = Vec::with_capacity(column_start[n] as usize);
        let mut values = Vec::with_capacity(column_start[n] as usize);
        for j in 0..n {
            for (row, value) in entries(j) {
                rows.push(row);
                values.push(value);
            }
        }
        SparseColMat::new(
            SymbolicSparseColMat::new_checked(n, n, column_start, None, rows),
            values,
        )
    }
}
