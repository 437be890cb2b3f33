//! The stiffness as faer's sparse matrix, to be multiplied with and written to files.

use faer::sparse::linalg::matmul::dense_sparse_matmul;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::body::Body;
use crate::error::Error;
use crate::sparse::assembly::{BlockMatrix, assemble_on};
use crate::sparse::graph::NodeGraph;

/// The stiffness of all displacements of a body [N/m], fixed ones included, as a sparse matrix of
/// faer's.
///
/// Vectors hold component after component, as those of [`crate::TensorOperator`]: displacement `c`
/// of node `n` is number `c * node_count + n`. The matrix is stored in panels of neighbouring
/// columns, both triangles of it, so that a product is one scalar product a column: the same bits
/// for any number of threads.
#[derive(Clone, Debug)]
pub struct SparseStiffness {
    dofs: usize,
    /// [`COLUMNS`] columns each, but the last; all rows.
    panels: Vec<SparseColMat<u32, f64>>,
}

/// Columns of a panel.
const COLUMNS: usize = 4096;

/// Memory of a block of 3 x 3 while the matrix is made [bytes]: its node, itself, and nine entries
/// with their rows.
const BYTES_A_BLOCK: u64 = 4 + 9 * 8 + 9 * (8 + 4);

/// Memory of a node in addition to its blocks [bytes]: its cells and the starts of rows and
/// columns.
const BYTES_A_NODE: u64 = 8 * 8 + 2 * 8 + 3 * 4;

impl SparseStiffness {
    /// Assembles the stiffness of a body, in parallel.
    ///
    /// Needs 184 bytes for each of some 27 neighbours of a node while it is made, of which 108
    /// stay; that is counted first.
    ///
    /// # Errors
    /// [`Error::MatrixTooLarge`] where it would need more than `limit` bytes; nothing is assembled
    /// then.
    ///
    /// ```
    /// use kufe_fem::{Body, ElementKind, Material, SparseStiffness};
    /// use kufe_mesh::TensorGrid;
    /// let axis = vec![0.0, 1.0, 2.0];
    /// let grid = TensorGrid { x: axis.clone(), y: axis.clone(), z: axis };
    /// let body = Body::uniform(grid.hex_mesh(), Material::new(1.0, 0.3)?, ElementKind::Hex8)?;
    /// let stiffness = SparseStiffness::assemble(&body, 1 << 20)?;
    /// let mut force = vec![1.0; body.dofs()];
    /// stiffness.apply(&vec![1.0; body.dofs()], &mut force);
    /// assert!(force.iter().all(|f| f.abs() < 1e-14)); // a translation costs nothing
    /// # Ok::<(), kufe_fem::Error>(())
    /// ```
    pub fn assemble(body: &Body, limit: u64) -> Result<Self, Error> {
        // The graph alone takes a twentieth of what the matrix does.
        let graph = NodeGraph::new(body.mesh());
        let blocks = graph.neighbours.len() as u64;
        let needed = BYTES_A_BLOCK * blocks + BYTES_A_NODE * graph.node_count() as u64;
        if needed > limit {
            return Err(Error::MatrixTooLarge {
                dofs: body.dofs(),
                needed,
                limit,
            });
        }
        let matrix = assemble_on(body, graph.into());
        let dofs = matrix.dofs();
        let panels = (0..dofs.div_ceil(COLUMNS))
            .into_par_iter()
            .map(|p| panel(&matrix, p * COLUMNS..((p + 1) * COLUMNS).min(dofs)))
            .collect();
        Ok(Self { dofs, panels })
    }

    /// Number of displacements.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Number of entries stored, both triangles.
    pub fn entries(&self) -> usize {
        self.panels.iter().map(|p| p.compute_nnz()).sum()
    }

    /// Memory that the matrix holds [bytes].
    pub fn bytes(&self) -> usize {
        12 * self.entries() + 4 * (self.dofs + self.panels.len())
    }

    /// `y` = K `u`, by component.
    ///
    /// # Panics
    /// Where a vector has another length.
    pub fn apply(&self, u: &[f64], y: &mut [f64]) {
        assert_eq!((u.len(), y.len()), (self.dofs, self.dofs));
        let tasks = y.par_chunks_mut(COLUMNS).zip(&self.panels);
        tasks.for_each(|(y, panel)| {
            // K is symmetric: a column times u is a row times u.
            dense_sparse_matmul(
                MatMut::from_row_major_slice_mut(y, 1, panel.ncols()),
                Accum::Replace,
                MatRef::from_row_major_slice(u, 1, self.dofs),
                panel.as_ref(),
                1.0,
                Par::Seq,
            );
        });
    }

    /// The entries of the lower triangle as (row, column, value [N/m]), column by column, rows
    /// ascending.
    pub fn lower(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let columns = self.panels.iter().enumerate().flat_map(|(p, panel)| {
            (0..panel.ncols()).map(move |local| (panel, local, p * COLUMNS + local))
        });
        columns.flat_map(|(panel, local, column)| {
            let panel = panel.as_ref();
            let rows = panel.symbolic().row_idx_of_col(local);
            let entries = rows.zip(panel.val_of_col(local));
            entries
                .filter(move |(row, _)| *row >= column)
                .map(move |(row, value)| (row, column, *value))
        })
    }
}

impl PartialEq for SparseStiffness {
    fn eq(&self, other: &Self) -> bool {
        self.dofs == other.dofs && self.lower().eq(other.lower())
    }
}

/// Some neighbouring columns of a matrix, by component.
fn panel(matrix: &BlockMatrix, columns: std::ops::Range<usize>) -> SparseColMat<u32, f64> {
    let graph = &matrix.graph;
    let nodes = graph.node_count();
    let mut start = Vec::with_capacity(columns.len() + 1);
    start.push(0u32);
    let entries = columns
        .clone()
        .map(|column| 3 * graph.row(column % nodes).len())
        .sum();
    let (mut rows, mut values) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
    for column in columns.clone() {
        let (c, node) = (column / nodes, column % nodes);
        let range = graph.row_start[node]..graph.row_start[node + 1];
        for i in 0..3 {
            // The matrix is symmetric, so a column's rows are read from the block row of its node.
            for (block, &other) in matrix.blocks[range.clone()].iter().zip(graph.row(node)) {
                rows.push((i * nodes) as u32 + other);
                values.push(block[c][i]);
            }
        }
        start.push(rows.len() as u32);
    }
    let pattern = SymbolicSparseColMat::new_checked(3 * nodes, columns.len(), start, None, rows);
    SparseColMat::new(pattern, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::{to_components, to_nodes};
    use crate::sparse::assembly::assemble;
    use crate::test_block::mixed;

    #[test]
    fn product_is_that_of_the_blocks_over_more_than_one_panel_and_for_any_number_of_threads() {
        let body = mixed(14);
        let n = body.dofs();
        assert!(n > 2 * COLUMNS);
        let u: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
        let (mut by_node, mut expected) = (vec![0.0; n], vec![0.0; n]);
        to_nodes(&u, &mut by_node);
        let mut image = vec![0.0; n];
        assemble(&body).apply(&by_node, &mut image);
        to_components(&image, &mut expected);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let mut found = vec![f64::NAN; n];
            pool.build().unwrap().install(|| {
                let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
                stiffness.apply(&u, &mut found);
            });
            found
        };
        let found = with(1);
        let size = expected.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-13 * size);
        }
        assert_eq!(found, with(3));
    }

    #[test]
    fn lower_triangle_with_its_mirror_is_the_matrix() {
        let body = mixed(2);
        let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
        let n = stiffness.dofs();
        let u: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).cos()).collect();
        let (mut expected, mut found) = (vec![0.0; n], vec![0.0; n]);
        stiffness.apply(&u, &mut expected);
        let mut stored = 0;
        for (row, column, value) in stiffness.lower() {
            found[row] += value * u[column];
            if row > column {
                found[column] += value * u[row];
                stored += 1;
            }
            stored += 1;
        }
        assert_eq!(stored, stiffness.entries());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn a_matrix_beyond_the_limit_is_refused_with_its_bytes() {
        let body = mixed(3);
        let stiffness = SparseStiffness::assemble(&body, u64::MAX).unwrap();
        let limit = stiffness.bytes() as u64;
        let error = SparseStiffness::assemble(&body, limit).unwrap_err();
        assert!(
            matches!(error, Error::MatrixTooLarge { needed, .. } if needed > limit && needed < 3 * limit),
            "{error}"
        );
    }
}
